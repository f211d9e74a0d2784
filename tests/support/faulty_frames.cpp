#include "tests/support/faulty_frames.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "engine/base/constants.h"
#include "engine/grid/grid.h"
#include "engine/localize/access_point_map.h"
#include "engine/observe/alignment.h"

namespace rayloc::test {
namespace {

using ToneValue = std::complex<float>;

// Row of the core in the frame; empty if the frame is from another access point or lacks the core.
std::optional<std::size_t> row_of(const CsiFrame& frame,
                                  std::size_t access_point,
                                  std::uint8_t rx_chain) {
  const auto found = std::find(frame.rx_chains.begin(), frame.rx_chains.end(), rx_chain);
  if (frame.access_point != access_point || found == frame.rx_chains.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - frame.rx_chains.begin());
}

using Array = std::vector<std::complex<double>>;  // [rx_chain][tone]

// Positions of the room's tones and of the access point's cores in a frame; empty when one is
// missing.
std::vector<ToneValue*> values_of(CsiFrame& frame,
                                  const RoomModel& room,
                                  const RoomAccessPoint& ap) {
  std::vector<ToneValue*> at;
  for (const std::uint8_t rx_chain : ap.rx_chains) {
    const auto row = std::find(frame.rx_chains.begin(), frame.rx_chains.end(), rx_chain);
    for (const std::int16_t tone : room.grid.tone_index) {
      const auto k = std::find(frame.tone_index.begin(), frame.tone_index.end(), tone);
      if (row == frame.rx_chains.end() || k == frame.tone_index.end()) {
        return {};
      }
      at.push_back(&frame.csi.row(static_cast<std::size_t>(row - frame.rx_chains.begin()),
                                  0)[static_cast<std::size_t>(k - frame.tone_index.begin())]);
    }
  }
  return at;
}

// Output of the chains for all paths, and for the direct path only.
struct Expected {
  Array all;
  Array direct;
};

Expected expected_of(const RoomModel& room, std::size_t access_point, const Vec3d& device) {
  const Vec3d aside{0.01, 0.01, 0.0};
  const AccessPointMap map({std::make_shared<const RoomModel>(room),
                            access_point,
                            Grid(device - aside, device + aside, device.z, 2.0 * aside.x),
                            LikelihoodKind::kPartial},
                           nullptr);
  const RoomAccessPoint& ap = room.access_points[access_point];
  Expected expected{map.expected(map.rays_to(device)), {}};
  for (std::size_t m = 0; m < ap.rx_chains.size(); ++m) {
    const double delay = norm(device - element_position(ap.array, m)) / kSpeedOfLight;
    for (std::size_t k = 0; k < room.grid.size(); ++k) {
      expected.direct.push_back(
          std::polar(1.0, -2.0 * std::numbers::pi * room.grid.frequency_hz(k) * delay));
    }
  }
  // Scales the direct path to its least-squares amplitude within all paths.
  const Aligner aligner(room.grid);
  aligner.apply(aligner.align(expected.all, expected.direct), expected.direct);
  for (std::size_t j = 0; j < expected.all.size(); ++j) {
    expected.all[j] *= ap.gains.gain[j];
    expected.direct[j] *= ap.gains.gain[j];
  }
  return expected;
}

}  // namespace

void kill_chain(std::vector<CsiFrame>& frames,
                std::size_t access_point,
                std::uint8_t rx_chain,
                std::mt19937& random) {
  std::normal_distribution<float> normal;
  for (CsiFrame& frame : frames) {
    const auto dead = row_of(frame, access_point, rx_chain);
    if (!dead) {
      continue;
    }
    const std::size_t rx_chains = frame.rx_chains.size();
    if (rx_chains < 2) {
      continue;  // no other chain to compare with
    }
    double power = 0.0;
    for (std::size_t m = 0; m < rx_chains; ++m) {
      for (const ToneValue& value : frame.csi.row(m, 0)) {
        power += m == *dead ? 0.0 : static_cast<double>(std::norm(value));
      }
    }
    const auto row = frame.csi.row(*dead, 0);
    const auto next = frame.csi.row((*dead + 1) % rx_chains, 0);
    power /= static_cast<double>((rx_chains - 1) * row.size());
    const auto noise = static_cast<float>(std::sqrt(0.5 * power * std::pow(10.0, -3.1)));
    const auto coupling = static_cast<float>(std::pow(10.0, -1.4));
    for (std::size_t k = 0; k < row.size(); ++k) {
      const float real = noise * normal(random);
      row[k] = coupling * next[k] + ToneValue(real, noise * normal(random));
    }
  }
}

void turn_chain(std::vector<CsiFrame>& frames,
                std::size_t access_point,
                std::uint8_t rx_chain,
                double phase) {
  const ToneValue turn = std::polar(1.0F, static_cast<float>(phase));
  for (CsiFrame& frame : frames) {
    if (const auto row = row_of(frame, access_point, rx_chain)) {
      for (ToneValue& value : frame.csi.row(*row, 0)) {
        value *= turn;
      }
    }
  }
}

void obstruct(std::vector<CsiFrame>& frames,
              std::size_t access_point,
              const RoomModel& room,
              const Vec3d& device) {
  constexpr double kTaken = 0.97;
  const Expected expected = expected_of(room, access_point, device);
  const Aligner aligner(room.grid);
  for (CsiFrame& frame : frames) {
    if (frame.access_point != access_point) {
      continue;
    }
    const auto values = values_of(frame, room, room.access_points[access_point]);
    Array h;
    for (const ToneValue* value : values) {
      h.emplace_back(*value);
    }
    if (!h.empty()) {
      aligner.apply(aligner.align(expected.all, h), h);
    }
    for (std::size_t j = 0; j < h.size(); ++j) {
      *values[j] = ToneValue(h[j] - kTaken * expected.direct[j]);
    }
  }
}

std::vector<std::complex<double>> strange_channel(std::size_t rx_chains,
                                                  std::span<const double> offset_hz,
                                                  std::mt19937& random) {
  constexpr int kTaps = 40;
  constexpr double kDecay = 30e-9;  // [s]
  std::normal_distribution<double> normal;
  std::exponential_distribution<double> delay(1.0 / kDecay);
  std::vector<std::complex<double>> h(rx_chains * offset_hz.size());
  for (std::size_t m = 0; m < rx_chains; ++m) {
    for (int tap = 0; tap < kTaps; ++tap) {
      const double real = normal(random);
      const std::complex<double> amplitude(real, normal(random));
      const double late = delay(random);
      for (std::size_t k = 0; k < offset_hz.size(); ++k) {
        h[m * offset_hz.size() + k] +=
            amplitude * std::polar(1.0, -2.0 * std::numbers::pi * offset_hz[k] * late);
      }
    }
  }
  return h;
}

}  // namespace rayloc::test
