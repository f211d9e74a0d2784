#include "daemon/pipeline/pipeline.h"

#include <algorithm>
#include <utility>

#include "rayloc/v1/location.pb.h"

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

void Pipeline::estimate_all() {
  BurstCollector collector(options_.burst);
  std::vector<Burst> ended;
  std::vector<v1::Location> locations;
  Timestamp newest = Timestamp::min();
  for (bool more = true; more;) {
    FrameMailbox::Taken taken = mailbox_.take();
    more = !taken.ended;
    const std::size_t frames = taken.frames.size();
    for (CsiFrame& frame : taken.frames) {
      newest = std::max(newest, frame.time);
      collector.add(std::move(frame), ended);
    }
    collector.advance(taken.safe_time, ended);
    {
      const std::lock_guard lock(mutex_);
      counters_.taken += frames;
      counters_.refused = collector.refused();
      counters_.in_flight = collector.in_flight();
      counters_.bursts_in_flight = collector.open_bursts() + ended.size();
      for (const Burst& burst : ended) {
        counters_.in_flight += burst.frames.size() + burst.surplus;
      }
    }
    explain(ended);
    const Timestamp open = collector.earliest_open(taken.safe_time);
    if (!hurried_ && newest != Timestamp::min()) {
      // Silence is known up to the newest frame, however far the sources can promise it.
      estimator_.advance(std::min(open, newest), locations);
      publish(locations);
    }
    sink_.advance(open);
  }
  finished_ = true;
}

void Pipeline::explain(std::vector<Burst>& bursts) {
  std::vector<v1::Location> locations;
  for (const Burst& burst : bursts) {
    if (hurried_) {
      break;
    }
    locations.clear();
    estimator_.estimate(burst, locations);
    {
      const std::lock_guard lock(mutex_);
      counters_.in_flight -= burst.frames.size() + burst.surplus;
      counters_.surplus += burst.surplus;
      (locations.empty() ? counters_.unwanted : counters_.used) += burst.frames.size();
      ++counters_.bursts;
      --counters_.bursts_in_flight;
    }
    publish(locations);
  }
  bursts.clear();
}

void Pipeline::publish(std::vector<v1::Location>& locations) {
  {
    const std::lock_guard lock(mutex_);
    for (const v1::Location& location : locations) {
      ++counters_.locations;
      counters_.no_fix += location.mode() == v1::FIX_MODE_NO_FIX ? 1U : 0U;
    }
  }
  for (v1::Location& location : locations) {
    sink_.location(std::move(location));
  }
  locations.clear();
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

EstimationCounters Pipeline::estimation_counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
