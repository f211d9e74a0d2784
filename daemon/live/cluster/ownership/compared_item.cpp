#include "daemon/live/cluster/ownership/compared_item.h"

namespace rayloc {

std::string compared(const v1::OutputItem& item, Likeness likeness) {
  if (likeness == Likeness::kSameBytes) {
    return item.SerializeAsString();
  }
  if (item.location().kind() != v1::LOCATION_KIND_SNAPSHOT) {
    return "";
  }
  v1::Location of;
  *of.mutable_time() = item.location().time();
  *of.mutable_target() = item.location().target();
  of.mutable_target()->clear_track();
  return of.SerializeAsString();
}

}  // namespace rayloc
