#include "daemon/messages/location.h"

#include <utility>

namespace rayloc {

Location filtered_location(const FilteredEstimate& estimate,
                           Target target,
                           LocationContext context) {
  return {estimate.location,
          std::move(target),
          std::move(context),
          Tracked{estimate.state, estimate.predicted, estimate.velocity}};
}

}  // namespace rayloc
