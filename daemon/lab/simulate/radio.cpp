#include "daemon/lab/simulate/radio.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kReferenceDistance = 4.0;  // [m], for Impairments::snr_db
// For two parallel half-wave dipoles: 1.64 each ([Balanis] 4.6).
constexpr double kReferenceGain = 1.64 * 1.64;
// Root mean square of the reported values, in dB: 98 to 113 in recordings (WIRE_FORMATS 3.1).
constexpr double kLevelDb = 105.0;
// Without gain control: equally far from the format's smallest and largest number.
constexpr double kFixedScale = 0x1p30;

double amplitude(double decibels) { return std::pow(10.0, decibels / 20.0); }
double power(double decibels) { return std::pow(10.0, decibels / 10.0); }
// Zero switches an impairment off.
double amplitude_below(double decibels) { return decibels > 0.0 ? amplitude(-decibels) : 0.0; }

// Index of the grid's tone nearest to `tone`: calibrations may leave out tones of the channel.
std::size_t nearest_tone(const OfdmGrid& grid, std::int16_t tone) {
  const auto above = std::lower_bound(grid.tone_index.begin(), grid.tone_index.end(), tone);
  if (above == grid.tone_index.end() ||
      (above != grid.tone_index.begin() && tone - *(above - 1) < *above - tone)) {
    return static_cast<std::size_t>(above - grid.tone_index.begin()) - 1;
  }
  return static_cast<std::size_t>(above - grid.tone_index.begin());
}

double mean_power(std::span<const Value> values) {
  double sum = 0.0;
  for (const Value& value : values) {
    sum += std::norm(value);
  }
  return sum / static_cast<double>(values.size());
}

}  // namespace

OfdmGrid radio_grid(const RadioSetup& setup) {
  const TonePlan& plan = tone_plan(setup.phy, setup.bandwidth_mhz);
  return {setup.centre_hz, plan.spacing_hz, plan.active};
}

SimulatedRadio::SimulatedRadio(const RadioSetup& setup,
                               const Impairments& impairments,
                               const ChainGains& calibrated,
                               RandomStream random)
    : setup_(setup), impairments_(impairments), random_(random) {
  chains_.grid = radio_grid(setup);
  chains_.rx_chains = setup.rx_chains;
  draw_chains(calibrated);
  draw_coupling(calibrated);
  if (impairments_.snr_db > 0.0) {
    const double wavelength = kSpeedOfLight / setup.centre_hz;
    const double link = wavelength / (2.0 * kTurn * kReferenceDistance);
    noise_power_ = kReferenceGain * link * link / power(impairments_.snr_db);
  }
}

void SimulatedRadio::draw_chains(const ChainGains& calibrated) {
  const double half = 0.5 * transform_size(setup_.phy, setup_.bandwidth_mhz);
  const bool known = impairments_.calibrated_chains && !calibrated.empty();
  RAYLOC_CHECK(!known || calibrated.rx_chains == chains_.rx_chains);
  for (std::size_t rx_chain = 0; rx_chain < chains_.rx_chains.size(); ++rx_chain) {
    const double level = impairments_.chain_gain_db * normal_(random_);
    const double phase = impairments_.chain_phase_deg * (2.0 * uniform_(random_) - 1.0);
    const double start_db = kTurn * uniform_(random_);
    const double start_deg = kTurn * uniform_(random_);
    // Drawn only if required: otherwise all other draws are unchanged.
    const double cable = impairments_.chain_delay_ns > 0.0
                             ? 1e-9 * impairments_.chain_delay_ns * normal_(random_)
                             : 0.0;
    for (const std::int16_t tone : chains_.grid.tone_index) {
      if (known) {
        const double hop = chains_.grid.centre_hz - calibrated.grid.centre_hz;
        chains_.gain.push_back(calibrated.gain[rx_chain * calibrated.grid.size() +
                                               nearest_tone(calibrated.grid, tone)] *
                               std::polar(1.0, -kTurn * hop * cable));
        continue;
      }
      // One period over the band.
      const double x = std::numbers::pi * tone / half;
      chains_.gain.push_back(std::polar(
          amplitude(level + impairments_.ripple_db * std::sin(x + start_db)),
          kDegree * (phase + impairments_.ripple_deg * std::sin(x + start_deg)) -
              kTurn * (chains_.grid.centre_hz + tone * chains_.grid.spacing_hz) * cable));
    }
  }
}

void SimulatedRadio::draw_coupling(const ChainGains& calibrated) {
  const double coupling = amplitude_below(impairments_.coupling_db);
  const double image = amplitude_below(impairments_.image_rejection_db);
  const std::size_t rx_chains = chains_.rx_chains.size();
  for (std::size_t m = 0; m < rx_chains; ++m) {
    for (std::size_t n = 0; n < rx_chains; ++n) {
      const double phase = kTurn * uniform_(random_);
      coupling_.push_back(m == n ? Value(1.0) : std::polar(coupling, phase));
    }
    image_.push_back(std::polar(image, kTurn * uniform_(random_)));
  }
  if (impairments_.calibrated_chains && !calibrated.coupling.empty()) {
    coupling_ = calibrated.coupling;
  }
}

void SimulatedRadio::turn_chains(std::span<const Value> factors) {
  RAYLOC_CHECK(factors.empty() || factors.size() == chains_.rx_chains.size());
  const std::size_t tones = chains_.grid.size();
  for (std::size_t i = 0; i < factors.size() * tones; ++i) {
    chains_.gain[i] *= factors[i / tones];
  }
}

void SimulatedRadio::draw_frames_from(RandomStream random) {
  random_ = random;
  normal_.reset();
}

Value SimulatedRadio::normal() {
  const double re = normal_(random_);
  const double im = normal_(random_);
  return std::numbers::sqrt2 * 0.5 * Value(re, im);
}

std::vector<Value> SimulatedRadio::transmit_error(std::uint64_t seed) const {
  RandomStream random(seed);
  std::normal_distribution<double> part;
  const double size = 0.5 * std::numbers::sqrt2 * amplitude_below(impairments_.transmit_snr_db);
  std::vector<Value> error;
  for (std::size_t k = 0; k < chains_.grid.size(); ++k) {
    const double re = part(random);
    const double im = part(random);
    error.push_back(size * Value(re, im));
  }
  return error;
}

std::vector<Value> SimulatedRadio::at_chains(std::span<const Value> h,
                                             std::uint64_t error_seed) const {
  const std::size_t tones = chains_.grid.size();
  const std::size_t rx_chains = chains_.rx_chains.size();
  const std::vector<Value> error = transmit_error(error_seed);
  std::vector<Value> signal(h.size());
  for (std::size_t m = 0; m < rx_chains; ++m) {
    for (std::size_t k = 0; k < tones; ++k) {
      Value at_antenna;
      for (std::size_t n = 0; n < rx_chains; ++n) {
        at_antenna += coupling_[m * rx_chains + n] * h[n * tones + k];
      }
      signal[m * tones + k] = chains_.gain[m * tones + k] * at_antenna * (1.0 + error[k]);
    }
  }
  return signal;
}

// Applies the frame's phase and timing offset, and the phase jitter of each core.
void SimulatedRadio::turn(std::vector<Value>& signal) {
  const std::size_t tones = chains_.grid.size();
  const double phase = impairments_.random_phase ? kTurn * uniform_(random_) : 0.0;
  double delay_ns = impairments_.delay_min_ns +
                    (impairments_.delay_max_ns - impairments_.delay_min_ns) * uniform_(random_);
  if (uniform_(random_) < impairments_.delay_outlier_share) {
    delay_ns += impairments_.delay_outlier_ns;
  }
  for (std::size_t m = 0; m < chains_.rx_chains.size(); ++m) {
    const double jitter =
        kDegree * impairments_.phase_jitter_deg / std::numbers::sqrt2 * normal_(random_);
    for (std::size_t k = 0; k < tones; ++k) {
      signal[m * tones + k] *=
          std::polar(1.0, phase + jitter - kTurn * chains_.grid.offset_hz(k) * delay_ns * 1e-9);
    }
  }
}

// Measured tones are symmetric about the centre
// (tone_plan.h; HE at 160 MHz by one tone not quite).
void SimulatedRadio::add_image(std::vector<Value>& signal) const {
  const std::size_t tones = chains_.grid.size();
  for (std::size_t m = 0; m < chains_.rx_chains.size(); ++m) {
    const std::span row = std::span(signal).subspan(m * tones, tones);
    for (std::size_t k = 0; 2 * k < tones; ++k) {
      Value& low = row[k];
      Value& high = row[tones - 1 - k];
      const Value image_of_low = image_[m] * std::conj(low);
      low += image_[m] * std::conj(high);
      high += image_of_low;
    }
  }
}

RadioFrame SimulatedRadio::on_channel(const std::vector<Value>& signal) {
  const TonePlan& plan = tone_plan(setup_.phy, setup_.bandwidth_mhz);
  const std::size_t tones = chains_.grid.size();
  const auto total = static_cast<std::size_t>(transform_size(setup_.phy, setup_.bandwidth_mhz));
  const auto middle = static_cast<std::ptrdiff_t>(total / 2);
  const double noise = std::sqrt(noise_power_);
  RadioFrame frame;
  frame.tones.resize(chains_.rx_chains.size() * total);
  for (std::size_t m = 0; m < chains_.rx_chains.size(); ++m) {
    const std::span row = std::span(frame.tones).subspan(m * total, total);
    for (Value& tone : row) {
      tone = noise * normal();
    }
    for (std::size_t k = 0; k < tones; ++k) {
      constexpr std::array<Value, 4> kQuarterTurns = {Value(1, 0), {0, 1}, {-1, 0}, {0, -1}};
      Value& tone = row[static_cast<std::size_t>(plan.active[k] + middle)];
      tone = kQuarterTurns.at(plan.quarter_turns[k]) * (tone + signal[m * tones + k]);
    }
    const double power = mean_power(std::span(signal).subspan(m * tones, tones));
    const Value garbage = std::sqrt(power) * normal();
    if (impairments_.dc_garbage) {
      row[total / 2] = garbage;
    }
    const double dbm = impairments_.transmit_power_dbm +
                       10.0 * std::log10(std::max(power + noise_power_, 1e-30)) +
                       impairments_.power_error_db * (2.0 * uniform_(random_) - 1.0);
    frame.power_dbm.at(chains_.rx_chains[m]) =
        static_cast<std::int8_t>(std::clamp(std::round(dbm), -128.0, -1.0));
  }
  return frame;
}

// Gain control holds the power to within a step; it takes the gain step below or above at random.
void SimulatedRadio::set_level(RadioFrame& frame) {
  const double chance = uniform_(random_);
  double scale = kFixedScale;
  const double power = mean_power(frame.tones);
  if (impairments_.gain_step_db > 0.0 && power > 0.0) {
    const double wanted = (kLevelDb - 10.0 * std::log10(power)) / impairments_.gain_step_db;
    scale = amplitude(impairments_.gain_step_db * std::floor(wanted + chance));
  }
  for (Value& tone : frame.tones) {
    tone *= scale;
  }
}

RadioFrame SimulatedRadio::receive(std::span<const Value> h, std::uint64_t transmit_error_seed) {
  RAYLOC_CHECK(h.size() == chains_.gain.size());
  std::vector<Value> signal = at_chains(h, transmit_error_seed);
  turn(signal);
  add_image(signal);
  RadioFrame frame = on_channel(signal);
  set_level(frame);
  return frame;
}

}  // namespace rayloc
