#include "daemon/pipeline/estimation_loop.h"

#include <algorithm>
#include <utility>

#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/warm/carried.h"

namespace rayloc {
namespace {

Timestamp time_of(const Location& location) { return location.estimate.time; }
Timestamp time_of(const TrackEvent& event) { return event.transition.time; }
Timestamp time_of(const ZoneEvent& event) { return event.time; }

template <typename Items>
void leave_out_before(Timestamp time, Items& items) {
  std::erase_if(items, [&](const auto& item) { return time_of(item) < time; });
}

}  // namespace

EstimationLoop::EstimationLoop(const PipelineOptions& options,
                               Estimator& estimator,
                               LocationSink& sink,
                               FrameMailbox& mailbox)
    : options_(options),
      estimator_(estimator),
      sink_(sink),
      mailbox_(mailbox),
      collector_(collector_options(), options.open),
      waiting_(queue_options()) {}

// A replay must not depend on the tracks that exist when a frame is taken, since that depends on
// timing. The list of transmitters does not.
CollectorOptions EstimationLoop::collector_options() const {
  CollectorOptions options = options_.burst;
  options.wanted = [this, live = is_live()](const MacAddress& transmitter) {
    const Rank rank = estimator_.rank(transmitter);
    return rank == Rank::kListed || rank == Rank::kListedAcquisition ||
           (live && rank == Rank::kTracked);
  };
  return options;
}

BurstQueueOptions EstimationLoop::queue_options() const {
  BurstQueueOptions options;
  options.overflow = options_.overflow;
  options.max_frames = options_.ring_frames;
  options.rank = [this](const MacAddress& transmitter) { return estimator_.rank(transmitter); };
  return options;
}

EstimationLoop::Step EstimationLoop::step(bool may_wait) {
  if (!more_ && is_collected_ && (waiting_.empty() || is_cancelled_)) {
    finish();
    return Step::kDone;
  }
  progress_.beat();
  // Live, new frames are taken before every burst; a replay processes all bursts first.
  if (waiting_.empty() || is_cancelled_ || is_live()) {
    if (is_collected_ && more_ && !take(may_wait)) {
      return Step::kWaits;
    }
    progress_.beat();
    if (!is_collected_) {
      collect();
    }
  }
  if (is_collected_ && std::exchange(taken_.moved, false)) {
    reset_after_seek();
    return Step::kMore;
  }
  if (!waiting_.empty() && !is_cancelled_) {
    explain(next_of_waiting());
  }
  advance_output();
  return Step::kMore;
}

// False if there is neither a frame nor a waiting burst.
bool EstimationLoop::take(bool may_wait) {
  const bool has_bursts = !waiting_.empty() && !is_cancelled_;
  if (may_wait && !has_bursts) {
    progress_.rest();
    taken_ = mailbox_.take();
  } else if (auto taken = mailbox_.try_take()) {
    taken_ = *std::move(taken);
  } else {
    return has_bursts;
  }
  more_ = !taken_.ended;
  is_collected_ = false;
  next_ = 0;
  uncounted_ = taken_.frames.size();
  return true;
}

// True if data are complete beyond a mark that has not been reached: a mark that cuts an open
// burst, or the last one before a frame. The result therefore depends on the frames alone.
bool EstimationLoop::reaches_mark(Timestamp time, bool is_frame) {
  const Duration every = options_.carry_every;
  if (every == Duration::zero()) {
    return false;
  }
  const bool cuts = mark_ && collector_.latest_end() > *mark_ + every;
  if (!cuts && !is_frame) {
    return false;
  }
  const Timestamp mark = cuts ? *mark_ + every : Timestamp(time.time_since_epoch() / every * every);
  if (mark_ && (mark <= *mark_ || mark > time)) {
    return false;
  }
  return std::exchange(mark_, mark).has_value();
}

// Collects the taken frames up to the next mark.
void EstimationLoop::collect() {
  const std::uint64_t passed_over = collector_.passed_over();
  while (has_frames() && !reaches_mark(taken_.frames[next_].time, true)) {
    CsiFrame& frame = taken_.frames[next_];
    newest_ = std::max(newest_, frame.time);
    collector_.add(std::move(frame), ended_);
    ++next_;
  }
  is_carry_due_ = has_frames() || reaches_mark(taken_.safe_time, false);
  is_collected_ = !is_carry_due_;
  safe_time_ = is_carry_due_ ? *mark_ : taken_.safe_time;
  note_silence();
  collector_.advance(safe_time_, ended_);
  note_waiting();
  // The end of the sources makes no burst too old: bursts that wait then are still processed.
  waiting_.push(ended_, more_ || !is_collected_ ? std::max(newest_, safe_time_) : newest_);
  count_collected(collector_.passed_over() - passed_over);
}

// Sources that have ended promise Timestamp::max().
void EstimationLoop::note_silence() {
  known_ = std::max(known_, newest_);
  if (options_.promises_are_kept && safe_time_ != Timestamp::max()) {
    known_ = std::max(known_, safe_time_);
  }
}

// Bursts that have ended begin to wait, unless an earlier one of their transmitter waits already.
void EstimationLoop::note_waiting() {
  for (const Burst& burst : ended_) {
    reported_.try_emplace(burst.transmitter, advanced_);
  }
}

// Returns the time up to which all results are published: of a transmitter that waits, predictions
// may follow that precede its bursts.
Timestamp EstimationLoop::promise(Timestamp open) {
  std::erase_if(reported_, [&](const auto& one) { return !waiting_.is_waiting(one.first); });
  for (const auto& [transmitter, time] : reported_) {
    open = std::min(open, time);
  }
  return open;
}

// Publishes the results that follow from silence, and the time up to which all are published.
void EstimationLoop::advance_output() {
  const Timestamp open = std::min(known_, waiting_.earliest(collector_.earliest_open(safe_time_)));
  if (!is_cancelled_ && open != Timestamp::min()) {
    Estimates estimates;
    estimator_.advance(
        open,
        [this](const MacAddress& transmitter) { return waiting_.is_waiting(transmitter); },
        estimates);
    publish(estimates);
    advanced_ = open;
  }
  const Timestamp done = promise(open);
  sink_.advance(done);
  if (is_carry_due_ && (waiting_.empty() || is_live())) {
    is_carry_due_ = false;
    carry(done);
  }
}

// Not before the results of the predecessor are complete: the carried state is valid from there.
void EstimationLoop::carry(Timestamp done) {
  if (is_cancelled_ || done < options_.from) {
    return;
  }
  Carried carried;
  carried.done = done;
  carried.open = collector_.open_starts(*mark_);
  carried.received = done;
  estimator_.carry(carried);
  sink_.carried(std::move(carried));
}

// Processes all bursts of the old position; tracks do not continue at the new one.
void EstimationLoop::reset_after_seek() {
  while (!waiting_.empty() && !is_cancelled_) {
    explain(next_of_waiting());
    progress_.beat();
  }
  restart_estimator("the recording was moved to another place");
  newest_ = safe_time_ = known_ = advanced_ = Timestamp::min();
  reported_.clear();
  mark_.reset();
  is_carry_due_ = false;
}

void EstimationLoop::finish() {
  std::string reason;
  {
    const std::lock_guard lock(mutex_);
    reason = std::exchange(end_of_tracks_, {});
  }
  if (!reason.empty()) {
    restart_estimator(reason);
  }
}

void EstimationLoop::restart_estimator(const std::string& reason) {
  Estimates estimates;
  estimator_.restart(reason, estimates);
  publish(estimates);
}

void EstimationLoop::end_tracks(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  end_of_tracks_ = reason;
}

void EstimationLoop::count_collected(std::uint64_t passed_over) {
  const std::lock_guard lock(mutex_);
  counters_.taken += std::exchange(uncounted_, 0);
  counters_.unwanted += passed_over;
  counters_.refused = collector_.refused();
  counters_.merged = waiting_.merged_frames();
  counters_.bursts_merged = waiting_.merged_bursts();
  counters_.dropped = waiting_.dropped_frames();
  counters_.bursts_dropped = waiting_.dropped_bursts();
  counters_.in_flight = collector_.in_flight() + waiting_.frames() + (taken_.frames.size() - next_);
  counters_.bursts_in_flight = collector_.open_bursts() + waiting_.size();
  count_ranks();
}

// REQUIRES: mutex_ is held, no burst is being processed.
void EstimationLoop::count_ranks() {
  if (is_live()) {
    counters_.ranks.assign(waiting_.by_rank().begin(), waiting_.by_rank().end());
  }
}

// Live, a transmitter has one burst in the queue.
std::vector<Burst> EstimationLoop::next_of_waiting() {
  return waiting_.pop(is_live() ? options_.bursts_at_once : 1);
}

void EstimationLoop::explain(std::vector<Burst> bursts) {
  std::vector<Estimates> estimates(bursts.size());
  estimator_.estimate_each(bursts, estimates);
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    count(bursts[i], estimates[i]);
    publish(estimates[i]);
  }
  estimator_.release(std::move(bursts));
  const std::lock_guard lock(mutex_);
  count_ranks();
}

void EstimationLoop::count(const Burst& burst, const Estimates& estimates) {
  const std::lock_guard lock(mutex_);
  counters_.in_flight -= burst.frames.size() + burst.surplus;
  counters_.surplus += burst.surplus + estimates.frames_left_out;
  (estimates.locations.empty() ? counters_.unwanted : counters_.used) +=
      burst.frames.size() - estimates.frames_left_out;
  ++counters_.bursts;
  --counters_.bursts_in_flight;
}

void EstimationLoop::publish(Estimates& estimates) {
  leave_out_before(options_.from, estimates.locations);
  leave_out_before(options_.from, estimates.events);
  leave_out_before(options_.from, estimates.zone_events);
  {
    const std::lock_guard lock(mutex_);
    for (const Location& location : estimates.locations) {
      if (location.is_filtered()) {
        ++counters_.filtered;
      } else {
        ++counters_.snapshots;
        counters_.no_fix += location.estimate.position ? 0U : 1U;
      }
    }
    counters_.events += estimates.events.size() + estimates.zone_events.size();
  }
  for (Location& location : estimates.locations) {
    sink_.location(std::move(location));
  }
  for (TrackEvent& event : estimates.events) {
    sink_.event(std::move(event));
  }
  for (ZoneEvent& event : estimates.zone_events) {
    sink_.event(std::move(event));
  }
}

EstimationCounters EstimationLoop::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
