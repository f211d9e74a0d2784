#include "daemon/pipeline/source_worker.h"

#include <utility>

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

void SourceWorker::start() {
  thread_ = std::thread([this] { run(); });
}

void SourceWorker::join() {
  if (thread_.joinable()) {
    thread_.join();
  }
}

void SourceWorker::run() {
  while (!stopping_ && lane_.step(kReadTimeout)) {
  }
  // Datagrams that were in the socket at the time of the stop have been received: they are still
  // taken, but a sender that continues does not extend this.
  for (int reads = 0; stopping_ && reads < kReadsAfterStop; ++reads) {
    if (!lane_.step(Duration::zero()) || lane_.was_idle()) {
      break;
    }
  }
  lane_.finish();
}

}  // namespace rayloc
