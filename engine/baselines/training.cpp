#include "engine/baselines/training.h"

#include <algorithm>

namespace rayloc {

const AccessPointTraining* Training::find(const std::string& id) const {
  const auto found = std::find_if(access_points.begin(),
                                  access_points.end(),
                                  [&](const AccessPointTraining& ap) { return ap.id == id; });
  return found == access_points.end() ? nullptr : &*found;
}

}  // namespace rayloc
