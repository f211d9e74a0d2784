#include "engine/track/person_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/grid/grid.h"
#include "engine/scene/scene.h"
#include "engine/track/filter_summary.h"
#include "engine/track/follow/tracked_moment.h"

namespace rayloc {
namespace {

// Height at which walls block a walk and chairs do not, as a share of the body's height.
constexpr double kWalkHeight = 0.8;
// Share of the power by which 95 % of the pairs of frames of a room at rest differ at most, beyond
// noise: the phases of the receive chains jitter by two degrees from one another.
constexpr double kStillChange = 3e-3;

FreeSpace make_space(const RoomModel& room, const WalkableArea& area, const TargetBody& body) {
  const Grid& grid = area.grid;
  FreeSpace space{grid,
                  area.free,
                  std::vector<std::uint8_t>(grid.size(), 0),
                  std::vector<std::uint8_t>(grid.size(), 0)};
  const double height = body.base + kWalkHeight * body.height;
  const auto at = [&](std::size_t cell) {
    Vec3d place = grid.centre(cell);
    place.z = height;
    return place;
  };
  const auto is_open = [&](std::size_t from, std::size_t to) {
    return space.free[from] != 0 && space.free[to] != 0 &&
           !room.scene->is_blocked({at(from), at(to)});
  };
  parallel_for(grid.size(), 64, [&](std::size_t cell) {
    space.link_x[cell] =
        cell + grid.count_y < grid.size() && is_open(cell, cell + grid.count_y) ? 1 : 0;
    space.link_y[cell] = (cell + 1) % grid.count_y != 0 && is_open(cell, cell + 1) ? 1 : 0;
  });
  return space;
}

// Squared correlation of the arrays of two moments, both aligned to the empty room.
double correlation(const PersonLikelihood::Observed& a, const PersonLikelihood::Observed& b) {
  const auto& x = a.y[PersonLikelihood::kDelays / 2];
  const auto& y = b.y[PersonLikelihood::kDelays / 2];
  std::complex<double> product;
  double power_x = 0.0;
  double power_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    product += std::conj(x[i]) * y[i];
    power_x += std::norm(x[i]);
    power_y += std::norm(y[i]);
  }
  return power_x > 0.0 && power_y > 0.0 ? std::norm(product) / (power_x * power_y) : 0.0;
}

}  // namespace

PersonTrackerCounters& PersonTrackerCounters::operator+=(const PersonTrackerCounters& other) {
  begun += other.begun;
  lost += other.lost;
  moments += other.moments;
  used += other.used;
  no_person += other.no_person;
  unexplained += other.unexplained;
  out_of_order += other.out_of_order;
  unusable += other.unusable;
  passed_over += other.passed_over;
  return *this;
}

PersonTracker::PersonTracker(std::shared_ptr<const PersonLocalizer> localizer,
                             PersonTrackerOptions options)
    : localizer_(std::move(localizer)),
      options_(std::move(options)),
      space_(std::make_shared<const FreeSpace>(make_space(
          localizer_->room(), localizer_->walkable_area(), localizer_->reference().person.body))),
      time_(options_.last_moment) {}

// Access points are weighted by the power that they receive from the person.
PersonTracker::Change PersonTracker::change_of(const PersonObservation& observation) const {
  double changed = 0.0;
  double unmoved = 0.0;
  double added = 0.0;
  std::size_t compared = 0;
  for (const PersonObservation::Array& now : observation.arrays) {
    for (const PersonObservation::Array& before : life_->last) {
      if (now.link == before.link) {
        const double noise = now.observed.noise + before.observed.noise + kStillChange;
        changed += 1.0 - correlation(before.observed, now.observed);
        unmoved += noise;
        added += 2.0 - now.observed.correlation - before.observed.correlation - noise;
        ++compared;
      }
    }
  }
  if (compared == 0 || added <= 0.0) {
    return {1.0, false};
  }
  return {std::clamp((changed - unmoved) / (options_.moved_change * added), 0.0, 1.0),
          compared == observation.arrays.size() && unmoved < added && changed <= unmoved};
}

std::uint64_t PersonTracker::number() const {
  return life_ ? life_->track : options_.first_number + numbers_ * options_.number_step;
}

void PersonTracker::begin(Timestamp time) {
  const std::uint64_t next = number();
  life_.emplace(Life{GridFilter(space_, options_.motion)});
  life_->track = next;
  life_->time = time;
  life_->weighed = time;
  life_->searched = time;
  ++counters_.begun;
}

void PersonTracker::predict(Timestamp time) {
  if (!options_.is_exhaustive && life_->moments > 0) {
    life_->filter.narrow(kOutOfWindow, time - life_->time);
  }
  life_->filter.predict(time - life_->time);
  life_->time = time;
}

PersonMap PersonTracker::map(const PersonObservation& observation,
                             const SearchedCells& searched) const {
  PersonContext context;
  context.cells = searched.cells;
  context.sample = searched.others;
  return localizer_->map(observation, localizer_->reference().person.likelihood_exponent, context);
}

// Evaluates the cells where the filter has a person. Evaluates the whole room if the filter is
// undecided, if no person is seen in these cells, and at regular intervals.
PersonMap PersonTracker::evaluate(const PersonObservation& observation) {
  Life& life = *life_;
  if (life.time - life.searched >= kWholeRoomPeriod || life.filter.away() > kMaxAway) {
    life.filter.widen();
  }
  const SearchedCells searched = searched_cells(life.filter, *space_, life.moments);
  if (!searched.is_all()) {
    PersonMap narrow = map(observation, searched);
    if (sight_of(narrow, 0.0) == Sight::kSeen) {
      return narrow;
    }
    life.filter.widen();
  }
  life.searched = life.time;
  return map(observation, {});
}

// Updates the filter with the cells that were evaluated.
void PersonTracker::learn(const PersonMap& map, double weight) {
  if (map.evaluated.is_all()) {
    life_->filter.update(map.log_likelihood, weight);
    return;
  }
  std::vector<double> log_likelihood;
  log_likelihood.reserve(map.evaluated.cells.size());
  for (const std::size_t cell : map.evaluated.cells) {
    log_likelihood.push_back(map.log_likelihood[cell]);
  }
  life_->filter.update(log_likelihood, map.evaluated, weight, 0.0);
}

PersonTracker::Sight PersonTracker::sight_of(const PersonMap& map, double least) {
  if (!map.is_explained || map.is_transmitter_suspect) {
    return Sight::kUnexplained;
  }
  return map.presence < least ? Sight::kNoPerson : Sight::kSeen;
}

PersonTracker::Sight PersonTracker::weigh(const PersonObservation& observation) {
  const PersonModel& person = localizer_->reference().person;
  const Timestamp time = observation.estimate.time;
  if (!life_) {
    PersonMap map = this->map(observation, {});
    const Sight sight = sight_of(map, kPresence);
    if (sight == Sight::kSeen) {
      begin(time);
      life_->filter.update(map.log_likelihood, 1.0);
      life_->within = std::move(map.within);
      life_->credit = 1.0;
      life_->last = observation.arrays;
    }
    return sight;
  }
  const Change change = change_of(observation);
  const double credit = life_->credit * (1.0 - change.share);
  const bool is_one_sided = person.front_offset_sigma > 0.0 && observation.arrays.size() == 1;
  const Duration same = is_one_sided ? options_.one_sided_evidence_time : options_.evidence_time;
  const double weight = snapshot_share(time - life_->weighed, same) * (1.0 - credit);
  life_->filter.weigh_change(change.share);
  life_->credit = credit;
  if (weight >= kMinBurstWeight) {
    PersonMap map = evaluate(observation);
    if (const Sight sight = sight_of(map, 0.0); sight != Sight::kSeen) {
      return sight;
    }
    learn(map, weight);
    life_->within = std::move(map.within);
    life_->credit += weight;
    life_->is_clear = map.presence >= kPresence;
  }
  life_->weighed = time;
  // While noise explains the change the remembered arrays stay, so that a slow movement adds up.
  if (!change.is_rest) {
    life_->last = observation.arrays;
  }
  return Sight::kSeen;
}

std::optional<TrackTransition> PersonTracker::age(Timestamp time, bool is_seen) {
  const bool is_new = life_->moments == 0;
  TrackState after = life_->state;
  std::string reason;
  if (is_seen) {
    life_->seen = time;
    life_->clear = life_->is_clear ? time : life_->clear;
    ++life_->moments;
    if (life_->moments >= options_.confirming_moments) {
      after = TrackState::kConfirmed;
      reason = "seen often enough";
    }
  } else {
    const Duration silence = time - life_->seen;
    const bool tentative = life_->state == TrackState::kTentative;
    if (silence >= (tentative ? options_.forget_after : options_.lose_after)) {
      after = TrackState::kLost;
      reason = "not seen for too long";
    } else if (!tentative && silence >= options_.coast_after) {
      after = TrackState::kCoasting;
      reason = "not seen lately";
    }
  }
  if (time - life_->clear >= options_.unclear_after) {
    after = TrackState::kLost;
    reason = "not clearly seen for too long";
  }
  if (is_new) {
    return TrackTransition{time, std::nullopt, TrackState::kTentative, "seen for the first time"};
  }
  if (after == life_->state) {
    return std::nullopt;
  }
  const TrackTransition transition{time, life_->state, after, std::move(reason)};
  life_->state = after;
  return transition;
}

// Estimate for a time without a burst.
LocationEstimate PersonTracker::estimate_without_burst(Timestamp time) const {
  LocationEstimate location;
  location.accuracy_confidence = localizer_->options().accuracy_confidence;
  location.time = time;
  location.capture_start = life_->seen;
  location.capture_end = life_->seen;
  return location;
}

// Reports the state of the track; a lost track is removed.
void PersonTracker::report(LocationEstimate location,
                           bool is_seen,
                           std::optional<TrackTransition> transition,
                           std::vector<PersonUpdate>& updates) {
  PosteriorOptions options;
  options.accuracy_confidence = location.accuracy_confidence;
  options.max_hypotheses = localizer_->options().max_hypotheses;
  summarise_filter(
      life_->filter, space_->grid, options, is_seen ? life_->within : RefinedCells{}, location);
  PersonUpdate update;
  update.track = life_->track;
  update.estimate.location = std::move(location);
  update.estimate.state = life_->state;
  update.estimate.predicted = !is_seen;
  update.estimate.stationary = life_->filter.stationary();
  update.estimate.transition = std::move(transition);
  updates.push_back(std::move(update));
  if (life_->state == TrackState::kLost) {
    ++counters_.lost;
    numbers_ += life_->time < options_.numbered_before ? 0U : 1U;
    life_.reset();
  }
}

void PersonTracker::coast(Timestamp until, std::vector<PersonUpdate>& updates) {
  while (life_ && life_->due < until) {
    const Timestamp time = life_->due;
    life_->due += options_.coasting_interval;
    predict(time);
    auto transition = age(time, false);
    report(estimate_without_burst(time), false, std::move(transition), updates);
  }
}

void PersonTracker::receive_moment(std::span<const CsiFrame> frames,
                                   std::vector<PersonUpdate>& updates) {
  ++counters_.moments;
  PersonObservation observation = localizer_->receive(frames);
  if (observation.arrays.empty()) {
    ++counters_.unusable;
    return;
  }
  const Timestamp time = observation.estimate.time;
  if ((time_ && time <= *time_) || (life_ && time <= life_->time)) {
    ++counters_.out_of_order;
    return;
  }
  if (life_) {
    predict(time);
  }
  time_ = time;
  const Sight sight = weigh(observation);
  const bool is_seen = sight == Sight::kSeen;
  counters_.used += is_seen ? 1U : 0U;
  counters_.no_person += sight == Sight::kNoPerson ? 1U : 0U;
  counters_.unexplained += sight == Sight::kUnexplained ? 1U : 0U;
  if (!life_) {
    return;
  }
  auto transition = age(time, is_seen);
  life_->due = std::max(life_->seen + options_.coast_after, time + options_.coasting_interval);
  report(std::move(observation.estimate), is_seen, std::move(transition), updates);
}

void PersonTracker::restart(const std::string& reason, std::vector<PersonUpdate>& updates) {
  if (life_) {
    // Later than the last estimate, because an event of one instant has one name (event_id).
    const Timestamp time = life_->time + std::chrono::microseconds(1);
    const TrackTransition lost{time, life_->state, TrackState::kLost, reason};
    life_->state = TrackState::kLost;
    report(estimate_without_burst(time), false, lost, updates);
  }
  time_.reset();
}

void PersonTracker::advance(Timestamp now, std::vector<PersonUpdate>& updates) {
  coast(now, updates);
}

void PersonTracker::receive(std::span<const CsiFrame> frames,
                            std::vector<PersonUpdate>& updates,
                            std::optional<Timestamp> received_since) {
  if (frames.empty()) {
    return;
  }
  coast(received_since.value_or(frames.front().time), updates);
  for (std::size_t begin = 0; begin < frames.size();) {
    std::size_t end = begin + 1;
    const Duration since = time_ ? frames[begin].time - *time_ : options_.interval;
    if (since >= Duration::zero() && since < options_.interval) {
      ++counters_.passed_over;
      begin = end;
      continue;
    }
    while (end < frames.size() && frames[end].time - frames[begin].time <= options_.moment) {
      ++end;
    }
    receive_moment(frames.subspan(begin, end - begin), updates);
    begin = end;
  }
}

}  // namespace rayloc
