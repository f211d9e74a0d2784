#include "daemon/pipeline/source_worker.h"

#include <utility>

namespace rayloc {
namespace {

// How long an idle source may sleep: the resolution of event time while nothing arrives, and the
// longest that a stop waits.
constexpr Duration kReadTimeout = std::chrono::milliseconds(20);

// More than a receive buffer of 8 MiB holds, at 64 datagrams a read.
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
  // What was in the socket when the stop came has been received: it is still taken, but not for as
  // long as somebody goes on sending.
  for (int reads = 0; stopping_ && reads < kReadsAfterStop; ++reads) {
    if (!lane_.step(Duration::zero()) || lane_.was_idle()) {
      break;
    }
  }
  lane_.finish();
}

}  // namespace rayloc
