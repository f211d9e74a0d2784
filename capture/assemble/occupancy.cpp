#include "capture/assemble/occupancy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/channel/tone_plan.h"

namespace rayloc {
namespace {

constexpr std::size_t kMaxParts = 8;  // parts of 20 MHz
constexpr int kTonesOfHalf160 = 256;

// Power of each 20 MHz part and of the guard tones, in units of the frame's power.
struct PowerProfile {
  std::size_t parts = 0;
  std::array<double, kMaxParts> part{};
  double guard = 0.0;
};

bool is_high_efficiency(const AssembledFrame& frame) { return frame.header.phy == PhyFormat::kHe; }

// Mean power of the tones first..last, which are adjacent on the wire.
double mean_power(std::span<const std::complex<float>> row, int first, int last, bool he) {
  const std::size_t begin = wire_index(first, static_cast<int>(row.size()), he);
  const std::size_t count = static_cast<std::size_t>(last - first) + 1;
  // [complex.numbers.general]: an array of complex<float> may be read as pairs of float. Several
  // sums, because a single one would stall on its own result at every step.
  const auto* values = reinterpret_cast<const float*>(row.subspan(begin, count).data());
  std::array<float, 8> sums{};
  std::size_t i = 0;
  for (; i + sums.size() <= 2 * count; i += sums.size()) {
    for (std::size_t lane = 0; lane < sums.size(); ++lane) {
      sums[lane] += values[i + lane] * values[i + lane];
    }
  }
  double sum = 0.0;
  for (; i < 2 * count; ++i) {
    sum += static_cast<double>(values[i]) * static_cast<double>(values[i]);
  }
  for (const float lane : sums) {
    sum += static_cast<double>(lane);
  }
  return sum / static_cast<double>(count);
}

// Computed from the tones that every format fills and no extractor overwrites: 4..24 of +-32 from
// the part's centre (16..96 of +-128 for HE).
PowerProfile profile_of_row(std::span<const std::complex<float>> row, bool he) {
  const int scale = he ? 4 : 1;
  const int total = static_cast<int>(row.size());
  PowerProfile profile;
  profile.parts = row.size() / (scale == 1 ? 64U : 256U);
  for (std::size_t i = 0; i < profile.parts; ++i) {
    const int centre = -total / 2 + static_cast<int>(i) * 64 * scale + 32 * scale;
    profile.part[i] = (mean_power(row, centre - 24 * scale, centre - 4 * scale, he) +
                       mean_power(row, centre + 4 * scale, centre + 24 * scale, he)) /
                      2.0;
  }
  const int bandwidth_mhz = static_cast<int>(profile.parts) * 20;
  const TonePlan& plan = tone_plan(he ? PhyFormat::kHe : PhyFormat::kVht, bandwidth_mhz);
  // The two next to the outermost active tones: int16 chips write junk further out.
  profile.guard = (mean_power(row, plan.active.back() + 1, plan.active.back() + 2, he) +
                   mean_power(row, plan.active.front() - 2, plan.active.front() - 1, he)) /
                  2.0;
  return profile;
}

PowerProfile profile_of(const AssembledFrame& frame, std::span<const std::uint8_t> rows) {
  PowerProfile sum;
  for (const std::uint8_t slot : rows) {
    const PowerProfile row = profile_of_row(frame.row(slot), is_high_efficiency(frame));
    sum.parts = row.parts;
    double total = 0.0;
    for (const double power : row.part) {
      total += power;
    }
    if (!(total > 0.0)) {
      continue;  // the chain is switched off
    }
    for (std::size_t i = 0; i < row.parts; ++i) {
      sum.part[i] += row.part[i] / total;
    }
    sum.guard += row.guard / total;
  }
  return sum;
}

// Excess of the weakest part of [first, first + count) over everything outside, less (in dB) half
// the unevenness of the parts among themselves.
double prominence(const PowerProfile& profile, std::size_t first, std::size_t count) {
  double weakest = std::numeric_limits<double>::infinity();
  double strongest = 0.0;
  double outside = profile.guard;
  for (std::size_t i = 0; i < profile.parts; ++i) {
    if (i >= first && i < first + count) {
      weakest = std::min(weakest, profile.part[i]);
      strongest = std::max(strongest, profile.part[i]);
    } else {
      outside = std::max(outside, profile.part[i]);
    }
  }
  if (!(weakest > 0.0)) {
    return 0.0;
  }
  return weakest / std::max(outside, std::numeric_limits<double>::min()) *
         std::sqrt(weakest / strongest);
}

}  // namespace

std::size_t wire_index(int tone, int total_tones, bool high_efficiency) {
  if (total_tones == 2 * kTonesOfHalf160 && !high_efficiency) {
    const int block = tone < 0 ? kTonesOfHalf160 : 0;
    const int from_centre_of_half =
        tone < 0 ? tone + kTonesOfHalf160 / 2 : tone - kTonesOfHalf160 / 2;
    const int index = block + (from_centre_of_half & (kTonesOfHalf160 - 1));
    return static_cast<std::size_t>(index);
  }
  return static_cast<std::size_t>(tone & (total_tones - 1));
}

Occupancy find_occupancy(const AssembledFrame& frame, std::span<const std::uint8_t> rows) {
  const int bandwidth_mhz = frame.header.channel_bandwidth_mhz;
  const Occupancy whole{bandwidth_mhz, 0};
  if (bandwidth_mhz == 20 || rows.empty()) {
    return whole;
  }
  const PowerProfile profile = profile_of(frame, rows);
  const int tones_of_part = is_high_efficiency(frame) ? 256 : 64;
  Occupancy best = whole;
  double best_prominence = prominence(profile, 0, profile.parts);
  for (std::size_t count = profile.parts / 2; count >= 1; count /= 2) {
    for (std::size_t first = 0; first < profile.parts; first += count) {
      const double candidate = prominence(profile, first, count);
      if (candidate > best_prominence) {
        best_prominence = candidate;
        best.bandwidth_mhz = static_cast<int>(count) * 20;
        best.centre_tone =
            tones_of_part * static_cast<int>(2 * first + count) / 2 - frame.header.total_tones / 2;
      }
    }
  }
  return best;
}

bool has_legacy_tones(const AssembledFrame& frame,
                      std::span<const std::uint8_t> rows,
                      const Occupancy& occupancy) {
  const auto& legacy = tone_plan(PhyFormat::kLegacy, occupancy.bandwidth_mhz).active;
  const auto& vht = tone_plan(PhyFormat::kVht, occupancy.bandwidth_mhz).active;
  double only_vht = 0.0;
  double both = 0.0;
  int count_only_vht = 0;
  int count_both = 0;
  for (const std::uint8_t slot : rows) {
    const std::span<const std::complex<float>> row = frame.row(slot);
    for (const std::int16_t tone : vht) {
      const std::size_t index = wire_index(tone + occupancy.centre_tone,
                                           frame.header.total_tones,
                                           /*high_efficiency=*/false);
      if (index - frame.header.overwritten_first < frame.header.overwritten_count) {
        continue;
      }
      const auto power = static_cast<double>(std::norm(row[index]));
      const bool in_legacy = std::binary_search(legacy.begin(), legacy.end(), tone);
      (in_legacy ? both : only_vht) += power;
      ++(in_legacy ? count_both : count_only_vht);
    }
  }
  // Recordings: at most -17 dB in legacy frames, at least -2 dB in VHT frames.
  constexpr double kThreshold = 0.126;  // -9 dB
  return only_vht * count_both < kThreshold * both * count_only_vht;
}

}  // namespace rayloc
