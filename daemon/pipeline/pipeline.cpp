#include "daemon/pipeline/pipeline.h"

#include <pthread.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "daemon/pipeline/estimates.h"

namespace rayloc {

Pipeline::Pipeline(const PipelineOptions& options,
                   std::vector<SourceWorker::Input> sources,
                   Estimator& estimator,
                   LocationSink& sink)
    : options_(options),
      estimator_(estimator),
      sink_(sink),
      mailbox_(sources.size(), options.ring_frames, options.overflow) {
  for (SourceWorker::Input& source : sources) {
    workers_.push_back(
        std::make_unique<SourceWorker>(std::move(source), mailbox_, workers_.size()));
  }
}

Pipeline::~Pipeline() {
  hurry();
  stop();
}

void Pipeline::start() {
  estimation_ = std::thread([this] { estimate_all(); });
  for (const auto& worker : workers_) {
    worker->start();
  }
}

// A replay must not depend on which tracks there are when a frame is taken: that is a matter of
// timing. Who is listed is not.
CollectorOptions Pipeline::collector_options() const {
  CollectorOptions options = options_.burst;
  const bool live = options_.overflow == Overflow::kDropOldest;
  options.wanted = [this, live](const MacAddress& transmitter) {
    const Rank rank = estimator_.rank(transmitter);
    return rank == Rank::kListed || (live && rank == Rank::kTracked);
  };
  return options;
}

BurstQueueOptions Pipeline::queue_options() const {
  BurstQueueOptions options;
  options.overflow = options_.overflow;
  options.max_frames = options_.ring_frames;
  options.rank = [this](const MacAddress& transmitter) { return estimator_.rank(transmitter); };
  return options;
}

void Pipeline::estimate_all() {
  pthread_setname_np(pthread_self(), "estimation");  // for top -H
  BurstCollector collector(collector_options());
  BurstQueue waiting(queue_options());
  std::vector<Burst> ended;
  Timestamp newest = Timestamp::min();
  Timestamp safe_time = Timestamp::min();
  progress_.beat();
  for (bool more = true; more || (!waiting.empty() && !hurried_);) {
    // Live, what has come meanwhile is looked at before every burst; a replay explains them all.
    std::optional<FrameMailbox::Taken> taken;
    if (more && (waiting.empty() || hurried_)) {
      progress_.rest();
      taken = mailbox_.take();
    } else if (more && options_.overflow == Overflow::kDropOldest) {
      taken = mailbox_.try_take();
    }
    progress_.beat();
    if (taken) {
      more = !taken->ended;
      safe_time = taken->safe_time;
      const std::size_t frames = taken->frames.size();
      for (CsiFrame& frame : taken->frames) {
        newest = std::max(newest, frame.time);
        collector.add(std::move(frame), ended);
      }
      collector.advance(safe_time, ended);
      // Nothing is too old because the sources have ended: what waits then is still explained.
      waiting.push(ended, more ? std::max(newest, safe_time) : newest);
      count(collector, waiting, frames);
    }
    if (taken && taken->moved) {
      go_elsewhere(waiting);
      newest = safe_time = Timestamp::min();
      continue;
    }
    if (!waiting.empty() && !hurried_) {
      explain(waiting.pop());
    }
    // Silence is known up to the newest frame, however far the sources can promise it.
    const Timestamp open = std::min(newest, waiting.earliest(collector.earliest_open(safe_time)));
    if (!hurried_ && newest != Timestamp::min()) {
      Estimates estimates;
      estimator_.advance(open, estimates);
      publish(estimates);
    }
    sink_.advance(open);
  }
  finished_ = true;
  progress_.rest();
}

// Of what came before a move everything is explained; tracks do not go on behind it.
void Pipeline::go_elsewhere(BurstQueue& waiting) {
  while (!waiting.empty() && !hurried_) {
    explain(waiting.pop());
    progress_.beat();
  }
  Estimates estimates;
  estimator_.restart("the recording was moved to another place", estimates);
  publish(estimates);
}

void Pipeline::count(const BurstCollector& collector,
                     const BurstQueue& waiting,
                     std::size_t taken) {
  const std::lock_guard lock(mutex_);
  counters_.taken += taken;
  counters_.refused = collector.refused();
  counters_.merged = waiting.merged_frames();
  counters_.bursts_merged = waiting.merged_bursts();
  counters_.dropped = waiting.dropped_frames();
  counters_.bursts_dropped = waiting.dropped_bursts();
  counters_.in_flight = collector.in_flight() + waiting.frames();
  counters_.bursts_in_flight = collector.open_bursts() + waiting.size();
}

void Pipeline::explain(const Burst& burst) {
  Estimates estimates;
  estimator_.estimate(burst, estimates);
  {
    const std::lock_guard lock(mutex_);
    counters_.in_flight -= burst.frames.size() + burst.surplus;
    counters_.surplus += burst.surplus;
    (estimates.locations.empty() ? counters_.unwanted : counters_.used) += burst.frames.size();
    ++counters_.bursts;
    --counters_.bursts_in_flight;
  }
  publish(estimates);
}

void Pipeline::publish(Estimates& estimates) {
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

void Pipeline::stop() {
  for (const auto& worker : workers_) {
    worker->stop();
  }
  join();
}

void Pipeline::hurry() {
  hurried_ = true;
  mailbox_.close();
}

void Pipeline::wait() { join(); }

void Pipeline::join() {
  for (const auto& worker : workers_) {
    worker->join();
  }
  if (estimation_.joinable()) {
    estimation_.join();
  }
}

std::vector<SourceReport> Pipeline::source_reports() const {
  std::vector<SourceReport> reports;
  for (const auto& worker : workers_) {
    reports.push_back(worker->report());
  }
  return reports;
}

std::vector<MailboxCounters> Pipeline::mailbox_counters() const {
  std::vector<MailboxCounters> counters;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    counters.push_back(mailbox_.counters(i));
  }
  return counters;
}

std::vector<Stage> Pipeline::stages() const {
  std::vector<Stage> stages;
  for (const auto& worker : workers_) {
    stages.push_back({"source " + worker->report().access_point, &worker->progress()});
  }
  stages.push_back({"estimation", &progress_});
  return stages;
}

EstimationCounters Pipeline::estimation_counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
