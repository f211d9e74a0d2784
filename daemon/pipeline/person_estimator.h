// PersonEstimator: locates a person who carries no device, from the bursts of the site's fixed
// transmitters (device-free). Each burst gives a snapshot of the target person-1, NO_FIX when
// nobody is seen, and filtered estimates of the moments within it, of the target person-N with N
// the number of the track.
//
// A site without a reference of the empty room (`rayloc reference`) gives NO_FIX, with the reason.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/pipeline/pipeline.h"
#include "daemon/publish/location_message.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/localize/person_localizer.h"
#include "engine/track/person_tracker.h"
#include "rayloc/v1/location.pb.h"

namespace rayloc {

class PersonEstimator : public Estimator {
 public:
  struct Options {
    PersonLocalizerOptions localizer;
    PersonTrackerOptions tracker;
    Duration valid_for = std::chrono::milliseconds(450);  // until a next burst is overdue
  };

  // Reads the scene and prepares the room: up to a minute.
  static Expected<std::unique_ptr<PersonEstimator>> create(const Site& site,
                                                           const Options& options);

  void estimate(const Burst& burst, Estimates& out) override;
  void restart(const std::string& reason, Estimates& out) override;

 private:
  PersonEstimator(Site site, Options options)
      : site_(std::move(site)), options_(std::move(options)) {}
  // Of one fixed transmitter.
  struct Link {
    std::shared_ptr<const PersonLocalizer> localizer;
    PersonTracker tracker;
  };

  LocationContext context_of(std::uint64_t track) const;
  void append(const std::vector<PersonUpdate>& updates, Estimates& out) const;

  const Site site_;
  const Options options_;
  std::shared_ptr<const RoomModel> room_;
  std::map<MacAddress, Link> links_;
};

}  // namespace rayloc
