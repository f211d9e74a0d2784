// ZoneEstimator: an estimator whose locations contain the probability of each zone of the site, and
// that reports entries and exits (ZoneWatch).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/zones/zone_watch.h"
#include "daemon/site/model/site.h"
#include "engine/channel/mac_address.h"

namespace rayloc {

class ZoneEstimator : public Estimator {
 public:
  // `inner` outlives it. `before`: state of the predecessor that it continues; null: none.
  ZoneEstimator(Estimator& inner,
                const std::vector<SiteZone>& zones,
                const Carried* before = nullptr);

  void estimate(const Burst& burst, Estimates& out) override;
  void estimate_each(std::span<const Burst> bursts, std::span<Estimates> out) override;
  void advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) override;
  void restart(const std::string& reason, Estimates& out) override;
  void carry(Carried& carried) const override;
  Rank rank(const MacAddress& transmitter) const override { return inner_.rank(transmitter); }

 private:
  // For the locations from `first` on. `transmitter`: as for ZoneWatch::see().
  void update_zones(Estimates& out,
                    std::size_t first,
                    const std::optional<MacAddress>& transmitter = std::nullopt);

  Estimator& inner_;
  const std::vector<SiteZone> zones_;
  ZoneWatch watch_;
};

}  // namespace rayloc
