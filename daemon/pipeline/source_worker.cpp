#include "daemon/pipeline/source_worker.h"

#include <utility>

#include "daemon/pipeline/shared/receiver_pool.h"

namespace rayloc {
namespace {

// Maximum sleep of an idle source: the resolution of event time while no data arrive, and the
// maximum delay of a stop.
constexpr Duration kReadTimeout = std::chrono::milliseconds(20);

// More than a receive buffer of 8 MiB contains, at 64 datagrams a read.
constexpr int kReadsAfterStop = 256;

}  // namespace

SourceWorker::SourceWorker(Input input, FrameMailbox& mailbox, std::size_t slot)
    : lane_(std::move(input), mailbox, slot) {}

SourceWorker::~SourceWorker() {
  stop();
  join();
}

void SourceWorker::start(ReceiverPool* receivers) {
  if (receivers != nullptr && lane_.poll_descriptor()) {
    receivers_ = receivers;
    lane_.share_thread();
    receivers_->add(*this);
    return;
  }
  thread_ = std::thread([this] { run(); });
}

void SourceWorker::join() {
  if (receivers_ != nullptr) {
    receivers_->wait_for_end(*this);
  }
  if (thread_.joinable()) {
    thread_.join();
  }
}

void SourceWorker::run() {
  while (!stopping_ && lane_.step(kReadTimeout)) {
  }
  while (stopping_ && drain_once()) {
  }
  lane_.finish();
}

// Datagrams that were in the socket at the time of the stop have been received: they are still
// taken, but a sender that continues does not extend this. False: all are taken.
bool SourceWorker::drain_once() {
  return reads_after_stop_++ < kReadsAfterStop && lane_.step(Duration::zero()) && !lane_.was_idle();
}

bool SourceWorker::read_once() {
  if (!lane_.has_room()) {
    return true;
  }
  const bool continues = stopping_ ? drain_once() : lane_.step(Duration::zero());
  if (!continues) {
    lane_.finish();
  }
  return continues;
}

}  // namespace rayloc
