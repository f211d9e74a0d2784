// ZoneEstimator: an estimator whose locations say how probably they are in each zone of the site,
// and that tells who enters and leaves (ZoneWatch).
#pragma once

#include <string>
#include <vector>

#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/zone_watch.h"
#include "daemon/site/site.h"

namespace rayloc {

class ZoneEstimator : public Estimator {
 public:
  // `inner` outlives it.
  ZoneEstimator(Estimator& inner, const std::vector<SiteZone>& zones)
      : inner_(inner), zones_(zones), watch_(zones) {}

  void estimate(const Burst& burst, Estimates& out) override;
  void advance(Timestamp time, Estimates& out) override;
  void restart(const std::string& reason, Estimates& out) override;
  Rank rank(const MacAddress& transmitter) const override { return inner_.rank(transmitter); }

 private:
  void look_at(Estimates& out, std::size_t first);

  Estimator& inner_;
  const std::vector<SiteZone> zones_;
  ZoneWatch watch_;
};

}  // namespace rayloc
