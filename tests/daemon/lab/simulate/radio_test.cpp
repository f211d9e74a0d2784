// Tests each impairment alone, against the definition of its key. The test derotates the tones
// itself: at 40 MHz 802.11 multiplies those at and above the centre by j.
#include "daemon/lab/simulate/radio.h"
#include "engine/base/constants.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::radio_test {
namespace {

using Value = std::complex<double>;

constexpr double kCentre = 5.19e9;  // [Hz]
constexpr double kSpacing = 312'500.0;
constexpr double kScale = 0x1p30;  // without gain control
constexpr std::size_t kTotal = 128;
const RadioSetup kSetup = {PhyFormat::kVht, 40, kCentre, {2, 0, 3}};

class Radio {
 public:
  explicit Radio(const Impairments& impairments,
                 std::uint64_t seed = 1,
                 const ChainGains& calibrated = {})
      : radio_(kSetup, impairments, calibrated, random_stream(seed, "test")) {}

  SimulatedRadio& operator*() { return radio_; }
  SimulatedRadio* operator->() { return &radio_; }

  std::vector<Value> flat(double level = 1e-3) const {
    std::vector<Value> h(3 * radio_.grid().size());
    std::fill(h.begin(), h.end(), level);
    return h;
  }

  // [rx_chain][tone] as on the grid, in the scale of h, from the frame of a flat channel.
  std::vector<std::vector<Value>> receive() { return receive(flat()); }
  std::vector<std::vector<Value>> receive(const std::vector<Value>& h) {
    const RadioFrame frame = radio_.receive(h, ++error_seed_);
    std::vector<std::vector<Value>> rows;
    for (std::size_t rx_chain = 0; rx_chain < 3; ++rx_chain) {
      std::vector<Value>& row = rows.emplace_back();
      for (const std::int16_t tone : radio_.grid().tone_index) {
        const Value rotated =
            frame.tones[rx_chain * kTotal + static_cast<std::size_t>(tone + int{kTotal / 2})];
        row.push_back(rotated / kScale / (tone < 0 ? Value(1.0) : Value(0.0, 1.0)));
      }
    }
    return rows;
  }

 private:
  SimulatedRadio radio_;
  std::uint64_t error_seed_ = 0;
};

double decibels(double power) { return 10.0 * std::log10(power); }

double standard_deviation(const std::vector<double>& values) {
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  return std::sqrt(squares / n - sum * sum / n / n);
}

TEST(SimulatedRadio, WithoutImpairmentsReportsTheChannelItself) {
  Radio radio(no_impairments());
  std::vector<Value> h;
  for (std::size_t i = 0; i < radio.flat().size(); ++i) {
    h.push_back(std::polar(1e-3 + 1e-6 * static_cast<double>(i), 0.1 * static_cast<double>(i)));
  }
  const auto received = radio.receive(h);
  for (std::size_t rx_chain = 0; rx_chain < 3; ++rx_chain) {
    for (std::size_t k = 0; k < 114; ++k) {
      EXPECT_NEAR(std::abs(received[rx_chain][k] - h[rx_chain * 114 + k]), 0.0, 1e-15);
    }
  }
}

TEST(SimulatedRadio, WithoutImpairmentsLeavesUnmeasuredTonesEmpty) {
  Radio radio(no_impairments());
  const RadioFrame frame = radio->receive(radio.flat(), 1);
  ASSERT_EQ(frame.tones.size(), 3 * kTotal);
  EXPECT_EQ(std::count(frame.tones.begin(), frame.tones.end(), Value(0.0)), 3 * (128 - 114));
  EXPECT_EQ(frame.tones[kTotal / 2], Value(0.0)) << "DC";
}

TEST(SimulatedRadio, CommonPhaseIsUniformAndCommon) {
  Impairments impairments = no_impairments();
  impairments.random_phase = true;
  Radio radio(impairments);
  Value resultant;
  for (int n = 0; n < 1000; ++n) {
    const auto received = radio.receive();
    resultant += received[0][0] / std::abs(received[0][0]) / 1000.0;
    EXPECT_NEAR(std::arg(received[2][100] / received[0][0]), 0.0, 1e-9);
  }
  EXPECT_LT(std::abs(resultant), 0.1);  // three deviations of 1 / sqrt(1000)
}

TEST(SimulatedRadio, TimingOffsetFillsItsRangeAndHasOutliers) {
  Impairments impairments = no_impairments();
  impairments.delay_min_ns = 60.0;
  impairments.delay_max_ns = 350.0;
  impairments.delay_outlier_share = 0.25;
  impairments.delay_outlier_ns = 1000.0;
  Radio radio(impairments);
  std::vector<double> usual;
  int outliers = 0;
  for (int n = 0; n < 1000; ++n) {
    const auto received = radio.receive();
    // Tones -58 and -57: a turn is 3.2 us.
    const double delay_ns =
        -std::arg(received[1][1] / received[1][0]) / (2.0 * std::numbers::pi * kSpacing) * 1e9;
    EXPECT_NEAR(std::arg(received[0][80] / received[2][80]), 0.0, 1e-9)
        << "one offset for all cores";
    if (delay_ns < 500.0) {
      usual.push_back(delay_ns);
    } else {
      ++outliers;
    }
  }
  const auto [least, most] = std::minmax_element(usual.begin(), usual.end());
  EXPECT_GE(*least, 60.0 - 1e-6);
  EXPECT_LT(*least, 65.0);
  EXPECT_LE(*most, 350.0 + 1e-6);
  EXPECT_GT(*most, 345.0);
  EXPECT_NEAR(outliers, 250, 3 * 14);
}

TEST(SimulatedRadio, GainControlTakesTheTwoStepsAroundItsLevel) {
  Impairments impairments = no_impairments();
  impairments.gain_step_db = 3.0;
  Radio radio(impairments);
  std::set<int> steps;
  for (int n = 0; n < 200; ++n) {
    const RadioFrame frame = radio->receive(radio.flat(), 1);
    const double gain = decibels(std::norm(frame.tones[10])) - decibels(1e-6);
    EXPECT_NEAR(gain / 3.0, std::round(gain / 3.0), 1e-9);
    steps.insert(static_cast<int>(std::lround(gain / 3.0)));
  }
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(*steps.rbegin() - *steps.begin(), 1);
  // 114 of 128 tones at -60 dB: the level of 105 dB lies between.
  const double wanted = 105.0 + 60.0 - decibels(114.0 / 128.0);
  EXPECT_EQ(*steps.begin(), static_cast<int>(std::floor(wanted / 3.0)));
}

TEST(SimulatedRadio, NoiseIsThatOfALinkOfFourMetres) {
  Impairments impairments = no_impairments();
  impairments.snr_db = 31.0;
  Radio radio(impairments);
  // [Friis] with 2.15 dBi at both ends.
  const double link =
      decibels(std::pow(299'792'458.0 / kCentre / (4.0 * std::numbers::pi * 4.0), 2)) + 2 * 2.15;
  double on_tones = 0.0;
  double between = 0.0;
  for (int n = 0; n < 100; ++n) {
    const RadioFrame frame = radio->receive(radio.flat(), 1);
    for (std::size_t i = 0; i < 6; ++i) {
      between += std::norm(frame.tones[i] / kScale) / 600.0;
    }
    for (std::size_t i = 6; i < 62; ++i) {  // -58 to -3: not rotated
      on_tones += std::norm(frame.tones[i] / kScale - 1e-3) / 5600.0;
    }
  }
  EXPECT_NEAR(link - decibels(on_tones), 31.0, 0.3);
  EXPECT_NEAR(link - decibels(between), 31.0, 0.6);
}

TEST(SimulatedRadio, JitterIsTheDeviationBetweenTwoCores) {
  Impairments impairments = no_impairments();
  impairments.phase_jitter_deg = 2.0;
  Radio radio(impairments);
  std::vector<double> difference;
  for (int n = 0; n < 2000; ++n) {
    const auto received = radio.receive();
    difference.push_back(kDegreesPerRadian * std::arg(received[1][5] / received[0][5]));
  }
  EXPECT_NEAR(standard_deviation(difference), 2.0, 0.1);
}

TEST(SimulatedRadio, TheTransmittersErrorIsTheSameOnAllCores) {
  Impairments impairments = no_impairments();
  impairments.transmit_snr_db = 38.0;
  Radio radio(impairments);
  double power = 0.0;
  for (int n = 0; n < 100; ++n) {
    const auto received = radio.receive();
    for (std::size_t k = 0; k < 114; ++k) {
      power += std::norm(received[0][k] / 1e-3 - 1.0) / 11'400.0;
      EXPECT_NEAR(std::abs(received[0][k] - received[2][k]), 0.0, 1e-15);
    }
  }
  EXPECT_NEAR(decibels(power), -38.0, 0.2);
}

TEST(SimulatedRadio, TheImageAppearsAtTheMirroredTone) {
  Impairments impairments = no_impairments();
  impairments.image_rejection_db = 33.0;
  Radio radio(impairments);
  std::vector<Value> h = radio.flat(0.0);
  h[20] = 1e-3;  // core 2, tone -38
  const auto received = radio.receive(h);
  for (std::size_t k = 0; k < 114; ++k) {
    const double expected_db = k == 20 ? 0.0 : -33.0;
    if (k == 20 || k == 113 - 20) {
      EXPECT_NEAR(decibels(std::norm(received[0][k] / 1e-3)), expected_db, 1e-6) << k;
    } else {
      EXPECT_EQ(received[0][k], Value(0.0)) << k;
    }
  }
}

TEST(SimulatedRadio, CouplingBringsOneAntennasSignalToTheOthers) {
  Impairments impairments = no_impairments();
  impairments.coupling_db = 28.0;
  Radio radio(impairments);
  std::vector<Value> h = radio.flat(0.0);
  std::fill(h.begin(), h.begin() + 114, 1e-3);
  const auto received = radio.receive(h);
  EXPECT_NEAR(std::abs(received[0][7] - 1e-3), 0.0, 1e-15);
  EXPECT_NEAR(decibels(std::norm(received[1][7] / 1e-3)), -28.0, 1e-6);
  EXPECT_NEAR(decibels(std::norm(received[2][90] / 1e-3)), -28.0, 1e-6);
}

TEST(SimulatedRadio, GarbageAtDcIsAsLargeAsData) {
  Impairments impairments = no_impairments();
  impairments.dc_garbage = true;
  Radio radio(impairments);
  double power = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const RadioFrame frame = radio->receive(radio.flat(), 1);
    power += std::norm(frame.tones[kTotal / 2] / kScale) / 1000.0;
  }
  EXPECT_NEAR(power / 1e-6, 1.0, 0.15);
}

TEST(SimulatedRadio, PowerIsWholeDbmWithinTheStatedError) {
  Impairments impairments = no_impairments();
  impairments.transmit_power_dbm = 15.4;
  Radio exact(impairments);
  const auto power = exact->receive(exact.flat(), 1).power_dbm;
  EXPECT_EQ(power[0], -45);  // 15.4 dBm - 60 dB
  EXPECT_EQ(power[1], 0) << "a core that the radio does not have";
  EXPECT_EQ(power[2], -45);
  impairments.power_error_db = 1.0;
  Radio rough(impairments);
  std::set<int> seen;
  for (int n = 0; n < 200; ++n) {
    seen.insert(rough->receive(rough.flat(), 1).power_dbm[3]);
  }
  EXPECT_EQ(seen, (std::set<int>{-46, -45, -44}));
}

TEST(SimulatedRadio, ChainsAreDrawnOnceAPowerCycle) {
  Impairments impairments = no_impairments();
  impairments.chain_gain_db = 1.0;
  impairments.chain_phase_deg = 180.0;
  std::vector<double> level;
  Value resultant;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Radio radio(impairments, seed);
    const auto first = radio.receive();
    const auto second = radio.receive();
    EXPECT_EQ(first, second);
    for (std::size_t rx_chain = 0; rx_chain < 3; ++rx_chain) {
      level.push_back(decibels(std::norm(first[rx_chain][0] / 1e-3)));
      resultant += first[rx_chain][0] / std::abs(first[rx_chain][0]) / 900.0;
      EXPECT_NEAR(
          std::abs(first[rx_chain][0] / 1e-3 - radio->chains().gain[rx_chain * 114]), 0.0, 1e-12);
      EXPECT_NEAR(std::abs(first[rx_chain][0] - first[rx_chain][113]), 0.0, 1e-15) << "no ripple";
    }
  }
  EXPECT_NEAR(standard_deviation(level), 1.0, 0.1);
  EXPECT_LT(std::abs(resultant), 0.1);
}

// A cable turns the phase by its delay times the frequency, so on each channel otherwise.
TEST(SimulatedRadio, CablesShiftTheChainPhasesFromChannelToChannel) {
  Impairments impairments = no_impairments();
  impairments.calibrated_chains = true;
  const ChainGains calibrated = Radio(impairments)->chains();
  impairments.chain_delay_ns = 0.3;
  RadioSetup away = kSetup;
  away.centre_hz = kCentre + 130e6;
  std::vector<double> delay_ns;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const SimulatedRadio here(kSetup, impairments, calibrated, random_stream(seed, "test"));
    EXPECT_EQ(here.chains().gain, calibrated.gain) << "the channel of the calibration";
    const SimulatedRadio there(away, impairments, calibrated, random_stream(seed, "test"));
    const SimulatedRadio drawn_here(kSetup, impairments, {}, random_stream(seed, "test"));
    const SimulatedRadio drawn_there(away, impairments, {}, random_stream(seed, "test"));
    for (std::size_t rx_chain = 0; rx_chain < 3; ++rx_chain) {
      const auto turn = [&](const SimulatedRadio& a, const SimulatedRadio& b) {
        return b.chains().gain[rx_chain * 114] / a.chains().gain[rx_chain * 114];
      };
      EXPECT_NEAR(std::abs(turn(here, there) - turn(drawn_here, drawn_there)), 0.0, 1e-6);
      delay_ns.push_back(-std::arg(turn(here, there)) / (2.0 * std::numbers::pi * 0.130));
    }
  }
  EXPECT_NEAR(standard_deviation(delay_ns), 0.3, 0.03);
}

TEST(SimulatedRadio, FramesAreDrawnAnewFromAnotherStream) {
  Impairments impairments = no_impairments();
  impairments.snr_db = 20.0;
  Radio one(impairments);
  Radio same(impairments);
  Radio other(impairments);
  other->draw_frames_from(random_stream(1, "hop", 7));
  EXPECT_EQ(other->chains().gain, one->chains().gain);
  const auto first = one.receive();
  EXPECT_EQ(same.receive(), first);
  EXPECT_NE(other.receive(), first);
}

TEST(SimulatedRadio, RippleReachesItsAmplitudeWithinTheBand) {
  Impairments impairments = no_impairments();
  impairments.ripple_db = 0.3;
  impairments.ripple_deg = 2.0;
  Radio radio(impairments);
  const auto received = radio.receive();
  for (const auto& row : received) {
    double level = 0.0;
    double phase = 0.0;
    for (const Value& value : row) {
      level = std::max(level, std::abs(decibels(std::norm(value / 1e-3))));
      phase = std::max(phase, std::abs(kDegreesPerRadian * std::arg(value)));
    }
    EXPECT_NEAR(level, 0.3, 0.01);
    EXPECT_NEAR(phase, 2.0, 0.05);
  }
}

TEST(SimulatedRadio, TakesTheChainsOfACalibrationWhenAsked) {
  Impairments impairments = no_impairments();
  ChainGains calibrated{radio_grid(kSetup), kSetup.rx_chains, {}, {}};
  for (int i = 0; i < 3 * 114; ++i) {
    calibrated.gain.push_back(std::polar(1.0, 0.01 * i));
  }
  const SimulatedRadio ideal(kSetup, impairments, calibrated, random_stream(1, "test"));
  EXPECT_EQ(ideal.chains().gain[200], Value(1.0));
  impairments.calibrated_chains = true;
  const SimulatedRadio same(kSetup, impairments, calibrated, random_stream(1, "test"));
  EXPECT_EQ(same.chains().gain, calibrated.gain);
}

TEST(SimulatedRadio, TakesTheCouplingOfACalibrationWithItsChains) {
  Impairments impairments = no_impairments();
  impairments.calibrated_chains = true;
  ChainGains calibrated{radio_grid(kSetup), kSetup.rx_chains, {}, {}};
  calibrated.gain.assign(3 * calibrated.grid.size(), 1.0);
  calibrated.coupling = {1.0, 0.0, 0.0, {0.0, 0.1}, 1.0, 0.0, 0.0, 0.0, 1.0};
  Radio radio(impairments, 1, calibrated);
  std::vector<Value> h = radio.flat(0.0);
  std::fill(h.begin(), h.begin() + 114, 1e-3);
  const auto received = radio.receive(h);
  EXPECT_NEAR(std::abs(received[0][7] - 1e-3), 0.0, 1e-15);
  EXPECT_NEAR(std::abs(received[1][7] - Value(0.0, 1e-4)), 0.0, 1e-15);
  EXPECT_NEAR(std::abs(received[2][7]), 0.0, 1e-15);
}

// A calibration of every second tone.
TEST(SimulatedRadio, FillsTonesThatACalibrationLeavesOutByTheNearest) {
  Impairments impairments = no_impairments();
  impairments.calibrated_chains = true;
  ChainGains calibrated{{kCentre, kSpacing, {-58, -30, 30, 58}}, {2, 0, 3}, {}, {}};
  for (int i = 0; i < 12; ++i) {
    calibrated.gain.emplace_back(1.0 + i);
  }
  const SimulatedRadio radio(kSetup, impairments, calibrated, random_stream(1, "test"));
  const auto& gain = radio.chains().gain;
  EXPECT_EQ(gain[0], Value(1.0));         // -58
  EXPECT_EQ(gain[114 + 56], Value(6.0));  // core 0, -2: -30 is nearer than 30
  EXPECT_EQ(gain[114 + 57], Value(7.0));  // core 0, +2
  EXPECT_EQ(gain[2 * 114 + 113], Value(12.0));
}

TEST(SimulatedRadio, TheSameSeedGivesTheSameFrames) {
  Radio first(default_impairments(), 5);
  Radio second(default_impairments(), 5);
  Radio other(default_impairments(), 6);
  const auto received = first.receive();
  EXPECT_EQ(received, second.receive());
  EXPECT_NE(received, other.receive());
  EXPECT_NE(received, first.receive()) << "no two frames are alike";
}

}  // namespace
}  // namespace rayloc::radio_test
