#include "daemon/pipeline/zones/zone_estimator.h"

#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/warm/carried.h"

namespace rayloc {

ZoneEstimator::ZoneEstimator(Estimator& inner,
                             const std::vector<SiteZone>& zones,
                             const Carried* before)
    : inner_(inner),
      zones_(zones),
      watch_(before == nullptr ? ZoneWatch(zones) : ZoneWatch(zones, before->zones, before->done)) {
}

void ZoneEstimator::carry(Carried& carried) const {
  inner_.carry(carried);
  carried.zones = watch_.stays();
}

void ZoneEstimator::estimate(const Burst& burst, Estimates& out) {
  estimate_each({&burst, 1}, {&out, 1});
}

void ZoneEstimator::estimate_each(std::span<const Burst> bursts, std::span<Estimates> out) {
  std::vector<std::size_t> first;
  for (const Estimates& some : out) {
    first.push_back(some.locations.size());
  }
  inner_.estimate_each(bursts, out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    update_zones(out[i], first[i], bursts[i].transmitter);
  }
}

void ZoneEstimator::advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) {
  const std::size_t first = out.locations.size();
  inner_.advance(time, is_waiting, out);
  update_zones(out, first);
  watch_.advance(time, out.zone_events, is_waiting);
}

void ZoneEstimator::restart(const std::string& reason, Estimates& out) {
  const std::size_t first = out.locations.size();
  inner_.restart(reason, out);
  update_zones(out, first);
  watch_.restart(reason, out.zone_events);
}

void ZoneEstimator::update_zones(Estimates& out,
                                 std::size_t first,
                                 const std::optional<MacAddress>& transmitter) {
  for (std::size_t i = first; i < out.locations.size(); ++i) {
    fill_zones(zones_, out.locations[i]);
    watch_.see(out.locations[i], transmitter);
  }
}

}  // namespace rayloc
