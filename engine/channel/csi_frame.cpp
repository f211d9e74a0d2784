#include "engine/channel/csi_frame.h"

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

}  // namespace rayloc
