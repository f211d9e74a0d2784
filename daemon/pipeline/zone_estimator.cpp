#include "daemon/pipeline/zone_estimator.h"

#include "daemon/pipeline/estimates.h"

namespace rayloc {

void ZoneEstimator::estimate(const Burst& burst, Estimates& out) {
  const std::size_t first = out.locations.size();
  inner_.estimate(burst, out);
  look_at(out, first);
}

void ZoneEstimator::advance(Timestamp time, Estimates& out) {
  const std::size_t first = out.locations.size();
  inner_.advance(time, out);
  look_at(out, first);
  watch_.advance(time, out.zone_events);
}

void ZoneEstimator::restart(const std::string& reason, Estimates& out) {
  const std::size_t first = out.locations.size();
  inner_.restart(reason, out);
  look_at(out, first);
  watch_.restart(reason, out.zone_events);
}

void ZoneEstimator::look_at(Estimates& out, std::size_t first) {
  for (std::size_t i = first; i < out.locations.size(); ++i) {
    fill_zones(zones_, out.locations[i]);
    watch_.see(out.locations[i]);
  }
}

}  // namespace rayloc
