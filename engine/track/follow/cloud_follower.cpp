#include "engine/track/follow/cloud_follower.h"

#include <utility>

#include "engine/localize/localizer.h"
#include "engine/localize/place_search.h"
#include "engine/track/follow/hand_over_rules.h"
#include "engine/track/hand_over.h"
#include "engine/track/searched_cells.h"

namespace rayloc {

CloudFollower::CloudFollower(std::shared_ptr<const CloudRoom> room,
                             CloudFilter filter,
                             TrackOptions options,
                             Duration phase,
                             WeighedAccessPoints weighed)
    : room_(std::move(room)),
      filter_(std::move(filter)),
      options_(std::move(options)),
      phase_(phase),
      weighed_(std::move(weighed)),
      searched_(filter_.time()),
      search_period_(kFirstWholeRoomPeriod) {}

// Compares the moment with the whole room as the grid does. weight: share of it that is new.
void CloudFollower::search_room(const RoomObservation& observation, double weight) {
  const Localizer& localizer = *room_->localizer;
  SearchFocus focus;
  focus.is_quick = true;
  focus.layer_weight = layers_of(filter_.cloud(), localizer.grid());
  const auto evidence = localizer.evidence(observation, Localizer::Scan::kPlaces, focus);
  searched_ = filter_.time();
  if (!evidence.log_likelihood.empty()) {
    const RoomBest found = best_beside(
        filter_.cloud(), *room_->space, evidence.log_likelihood, options_.hand_over.rival_distance);
    lead_ =
        rival_lead(lead_, found, localizer.room().likelihood_exponent, weight, options_.hand_over);
  }
  search_period_ = next_search_period(search_period_, lead_);
}

std::optional<double> CloudFollower::weigh(const TrackedMoment& moment) {
  const RoomObservation& observation = moment.observation;
  const bool is_joining = !moment.is_rest && weighed_.is_joined_by(observation, filter_.time());
  if (is_joining || !PlaceSearch::can_search(observation)) {
    return std::nullopt;
  }
  const double is_new = 1.0 - moment.credit;
  const double weight = snapshot_share(moment.elapsed, options_.evidence_time) * is_new;
  if (weight >= kMinBurstWeight) {
    if (is_search_due(filter_.time(), searched_, search_period_, phase_)) {
      search_room(observation, is_new);
    }
    if (is_rival_better(lead_, options_.hand_over) || !filter_.weigh(observation, weight)) {
      return std::nullopt;
    }
  }
  if (moment.motion) {
    filter_.weigh_change(*moment.motion, options_.motion.change_odds);
  }
  filter_.note(moment.frames);
  // Also a moment that was not compared: the present channel has had its weight.
  weighed_.note(observation, filter_.time());
  return weight >= kMinBurstWeight ? moment.credit + weight : moment.credit;
}

void CloudFollower::summarise(const PosteriorOptions& options, LocationEstimate& location) {
  outside_ = filter_.summarise(options, location);
}

bool CloudFollower::settle() {
  const CloudWidth width{
      effective_cells(filter_.cloud(), room_->space->grid), filter_.away(), outside_};
  if (is_taken_back(width, options_.hand_over)) {
    return false;
  }
  filter_.thin();
  return true;
}

double CloudFollower::spread() const {
  return spread_of(filter_.away(), is_rival_better(lead_, options_.hand_over), options_.hand_over);
}

}  // namespace rayloc
