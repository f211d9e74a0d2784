#include "engine/baselines/paths/tone_comb.h"

#include <algorithm>

namespace rayloc {
namespace {

constexpr std::size_t kMaxTones = 32;  // of a comb, a count: the cost of a fix grows with its cube
constexpr std::size_t kMinTones = 8;   // of a comb, a count, chosen: fewer resolve no delays
constexpr int kLargestStep = 64;       // [tones], for a channel of 160 MHz with HE's narrow tones

}  // namespace

ToneComb tone_comb(const OfdmGrid& grid) {
  const auto place = [&](int index) -> std::size_t {
    const auto found = std::lower_bound(grid.tone_index.begin(), grid.tone_index.end(), index);
    return found == grid.tone_index.end() || *found != index
               ? grid.size()
               : static_cast<std::size_t>(found - grid.tone_index.begin());
  };
  for (int step = 2; step <= kLargestStep; step *= 2) {
    std::vector<std::size_t> lower;
    std::vector<std::size_t> upper;
    for (int index = step / 2; place(index) != grid.size() && place(-index) != grid.size();
         index += step) {
      upper.push_back(place(index));
      lower.push_back(place(-index));
    }
    const std::size_t tones = 2 * upper.size();
    if (tones >= kMinTones && tones <= kMaxTones) {
      ToneComb comb{{lower.rbegin(), lower.rend()}, step * grid.spacing_hz};
      comb.tone.insert(comb.tone.end(), upper.begin(), upper.end());
      return comb;
    }
  }
  return {};
}

}  // namespace rayloc
