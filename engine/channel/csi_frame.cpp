#include "engine/channel/csi_frame.h"

#include <algorithm>
#include <iterator>

#include "engine/base/check.h"

namespace rayloc {

std::string_view to_string(PhyFormat phy) {
  switch (phy) {
    case PhyFormat::kLegacy:
      return "legacy";
    case PhyFormat::kHt:
      return "ht";
    case PhyFormat::kVht:
      return "vht";
    case PhyFormat::kHe:
      return "he";
  }
  RAYLOC_CHECK(false);
}

bool is_on(const OfdmGrid& grid, const CsiFrame& frame) {
  return !frame.channel ||
         is_same_channel(*frame.channel, {grid.centre_hz, frame.channel->bandwidth_mhz});
}

std::vector<CsiFrame> frames_on(const OfdmGrid& grid, std::span<const CsiFrame> frames) {
  std::vector<CsiFrame> own;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(own), [&](const CsiFrame& frame) {
    return is_on(grid, frame);
  });
  return own;
}

}  // namespace rayloc
