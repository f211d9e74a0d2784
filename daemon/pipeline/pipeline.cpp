#include "daemon/pipeline/pipeline.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/estimation_loop.h"
#include "daemon/pipeline/shared/shared_threads.h"
#include "engine/base/parallel.h"

namespace rayloc {

void Estimator::estimate_each(std::span<const Burst> bursts, std::span<Estimates> out) {
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    estimate(bursts[i], out[i]);
  }
}

// Two for each core; with one core no burst waits for others, and with many not for long.
std::size_t PipelineOptions::default_bursts_at_once() {
  constexpr std::size_t kMost = 8;
  const std::size_t cores = concurrency();
  return cores > 1 ? std::min(2 * cores, kMost) : 1;
}

Pipeline::Pipeline(const PipelineOptions& options,
                   std::vector<SourceWorker::Input> sources,
                   Estimator& estimator,
                   LocationSink& sink)
    : threads_(options.threads),
      mailbox_(sources.size(), options.ring_frames, options.overflow),
      loop_(std::make_unique<EstimationLoop>(options, estimator, sink, mailbox_)) {
  for (SourceWorker::Input& source : sources) {
    workers_.push_back(
        std::make_unique<SourceWorker>(std::move(source), mailbox_, workers_.size()));
  }
}

Pipeline::~Pipeline() {
  cancel_pending();
  stop();
}

void Pipeline::start() {
  if (threads_) {
    turns_ = threads_->estimations.add([this] { return take_turn(); });
    mailbox_.on_advance([this] { turns_->wake(); });
  } else {
    estimation_ = std::thread([this] { estimate_all(); });
  }
  for (const auto& worker : workers_) {
    worker->start(threads_ ? &threads_->receivers : nullptr);
  }
}

void Pipeline::estimate_all() {
  pthread_setname_np(pthread_self(), "estimation");  // for top -H
  while (loop_->step(true) != EstimationLoop::Step::kDone) {
  }
  finished_ = true;
  loop_->progress().rest();
}

// Between its turns it waits for others.
WorkerPool::Turn Pipeline::take_turn() {
  const EstimationLoop::Step step = loop_->step(false);
  loop_->progress().rest();
  switch (step) {
    case EstimationLoop::Step::kMore:
      return WorkerPool::Turn::kMore;
    case EstimationLoop::Step::kWaits:
      return WorkerPool::Turn::kWaits;
    case EstimationLoop::Step::kDone:
      break;
  }
  finished_ = true;
  return WorkerPool::Turn::kEnded;
}

void Pipeline::stop() {
  for (const auto& worker : workers_) {
    worker->stop();
  }
  join();
}

void Pipeline::end_tracks(const std::string& reason) { loop_->end_tracks(reason); }

std::vector<std::unique_ptr<DatagramSource>> Pipeline::release_sources() {
  std::vector<std::unique_ptr<DatagramSource>> sources;
  sources.reserve(workers_.size());
  for (const auto& worker : workers_) {
    sources.push_back(worker->release());
  }
  return sources;
}

void Pipeline::cancel_pending() {
  loop_->cancel_pending();
  mailbox_.close();
}

void Pipeline::wait() { join(); }

void Pipeline::join() {
  for (const auto& worker : workers_) {
    worker->join();
  }
  if (turns_) {
    turns_->wait_for_end();
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
    stages.push_back({"source " + worker->report().access_point,
                      &worker->progress(),
                      worker->has_shared_thread()});
  }
  stages.push_back({"estimation", &loop_->progress(), turns_ != nullptr});
  return stages;
}

EstimationCounters Pipeline::estimation_counters() const { return loop_->counters(); }

}  // namespace rayloc
