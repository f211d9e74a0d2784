#include "engine/channel/tone_plan.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Range = std::pair<int, int>;  // first and last tone, inclusive

// [MHz], as IEEE 802.11-2020 has them.
constexpr std::array<int, 4> kBandwidths = {20, 40, 80, 160};

std::vector<std::int16_t> tones_of(std::initializer_list<Range> ranges) {
  std::vector<std::int16_t> tones;
  for (const auto& [first, last] : ranges) {
    for (int k = first; k <= last; ++k) {
      tones.push_back(static_cast<std::int16_t>(k));
    }
  }
  return tones;
}

std::vector<std::int16_t> mirrored(std::initializer_list<int> positive) {
  std::vector<std::int16_t> tones;
  for (const int k : positive) {
    tones.push_back(static_cast<std::int16_t>(k));
    tones.push_back(static_cast<std::int16_t>(-k));
  }
  std::sort(tones.begin(), tones.end());
  return tones;
}

// The 20 MHz pattern in each 20 MHz part of a wider channel.
std::vector<std::int16_t> duplicated(const std::vector<std::int16_t>& pattern, int bandwidth_mhz) {
  std::vector<std::int16_t> tones;
  const int parts = bandwidth_mhz / 20;
  for (int part = 0; part < parts; ++part) {
    const int centre = 64 * part - 32 * (parts - 1);
    for (const std::int16_t k : pattern) {
      tones.push_back(static_cast<std::int16_t>(k + centre));
    }
  }
  return tones;
}

std::vector<std::int16_t> vht_active(int bandwidth_mhz) {
  switch (bandwidth_mhz) {
    case 20:
      return tones_of({{-28, -1}, {1, 28}});
    case 40:
      return tones_of({{-58, -2}, {2, 58}});
    case 80:
      return tones_of({{-122, -2}, {2, 122}});
    default:
      return tones_of({{-250, -130}, {-126, -6}, {6, 126}, {130, 250}});
  }
}

std::vector<std::int16_t> vht_pilots(int bandwidth_mhz) {
  switch (bandwidth_mhz) {
    case 20:
      return mirrored({7, 21});
    case 40:
      return mirrored({11, 25, 53});
    case 80:
      return mirrored({11, 39, 75, 103});
    default:
      return mirrored({25, 53, 89, 117, 139, 167, 203, 231});
  }
}

// WIRE_FORMATS 1.4: the tones that the converter does not set to zero. Its zeros of 160 MHz are not
// symmetric, so this set is not either.
std::vector<std::int16_t> he_active(int bandwidth_mhz) {
  switch (bandwidth_mhz) {
    case 20:
      return tones_of({{-122, -2}, {2, 122}});
    case 40:
      return tones_of({{-244, -3}, {3, 244}});
    case 80:
      return tones_of({{-500, -3}, {3, 500}});
    default:
      return tones_of({{-1012, -516}, {-509, -12}, {12, 509}, {515, 1011}});
  }
}

// [11ax] pilots of the RU that spans the bandwidth.
std::vector<std::int16_t> he_pilots(int bandwidth_mhz) {
  switch (bandwidth_mhz) {
    case 20:
      return mirrored({22, 48, 90, 116});
    case 40:
      return mirrored({10, 36, 78, 104, 144, 170, 212, 238});
    case 80:
      return mirrored({24, 92, 158, 226, 266, 334, 400, 468});
    default:
      return mirrored(
          {44, 112, 178, 246, 286, 354, 420, 488, 536, 604, 670, 738, 778, 846, 912, 980});
  }
}

// [11ac] (21-14) to (21-17): gamma in quarter turns. HE-LTF is not rotated.
std::uint8_t quarter_turns_of(PhyFormat phy, int bandwidth_mhz, int k) {
  if (phy == PhyFormat::kHe) {
    return 0;
  }
  switch (bandwidth_mhz) {
    case 20:
      return 0;
    case 40:
      return k >= 0 ? 1 : 0;
    case 80:
      return k >= -64 ? 2 : 0;
    default:
      return (k >= 64 || (k >= -192 && k < 0)) ? 2 : 0;
  }
}

TonePlan make_plan(PhyFormat phy, int bandwidth_mhz) {
  TonePlan plan;
  plan.phy = phy;
  plan.bandwidth_mhz = bandwidth_mhz;
  plan.spacing_hz = tone_spacing_hz(phy);
  switch (phy) {
    case PhyFormat::kLegacy:
      plan.active = duplicated(tones_of({{-26, -1}, {1, 26}}), bandwidth_mhz);
      plan.pilots = duplicated(mirrored({7, 21}), bandwidth_mhz);
      break;
    case PhyFormat::kHt:
    case PhyFormat::kVht:
      plan.active = vht_active(bandwidth_mhz);
      plan.pilots = vht_pilots(bandwidth_mhz);
      break;
    case PhyFormat::kHe:
      plan.active = he_active(bandwidth_mhz);
      plan.pilots = he_pilots(bandwidth_mhz);
      break;
  }
  for (const std::int16_t k : plan.active) {
    plan.quarter_turns.push_back(quarter_turns_of(phy, bandwidth_mhz, k));
  }
  return plan;
}

std::size_t bandwidth_position(int bandwidth_mhz) {
  const auto* found = std::find(kBandwidths.begin(), kBandwidths.end(), bandwidth_mhz);
  RAYLOC_CHECK(found != kBandwidths.end());
  return static_cast<std::size_t>(found - kBandwidths.begin());
}

using Plans = std::array<std::array<TonePlan, kBandwidths.size()>, 4>;

Plans make_plans() {
  Plans plans;
  for (const PhyFormat phy :
       {PhyFormat::kLegacy, PhyFormat::kHt, PhyFormat::kVht, PhyFormat::kHe}) {
    for (std::size_t i = 0; i < kBandwidths.size(); ++i) {
      plans[static_cast<std::size_t>(phy)][i] = make_plan(phy, kBandwidths[i]);
    }
  }
  return plans;
}

}  // namespace

double tone_spacing_hz(PhyFormat phy) { return phy == PhyFormat::kHe ? 78'125.0 : 312'500.0; }

int transform_size(PhyFormat phy, int bandwidth_mhz) {
  RAYLOC_CHECK(bandwidth_position(bandwidth_mhz) < kBandwidths.size());
  return bandwidth_mhz / 20 * (phy == PhyFormat::kHe ? 256 : 64);
}

const TonePlan& tone_plan(PhyFormat phy, int bandwidth_mhz) {
  static const Plans kPlans = make_plans();  // made once, from IEEE 802.11-2020 and 802.11ax-2021
  return kPlans[static_cast<std::size_t>(phy)][bandwidth_position(bandwidth_mhz)];
}

}  // namespace rayloc
