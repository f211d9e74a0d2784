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
    : source_(std::move(input.source)),
      receiver_(input.receiver),
      mailbox_(mailbox),
      slot_(slot),
      taps_(std::move(input.taps)),
      frame_tap_(input.frame_tap),
      access_point_(std::move(input.access_point)) {
  report_.access_point = access_point_;
  report_.description = source_->description();
}

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
  DatagramBatch batch;
  std::vector<CsiFrame> frames;
  progress_.beat();
  while (!stopping_ && step(batch, frames, kReadTimeout)) {
  }
  // What was in the socket when the stop came has been received: it is still taken, but not for as
  // long as somebody goes on sending.
  for (int reads = 0; stopping_ && reads < kReadsAfterStop; ++reads) {
    if (!step(batch, frames, Duration::zero()) || batch.datagrams.empty()) {
      break;
    }
  }
  receiver_.flush(frames);
  show(frames);
  progress_.rest();
  mailbox_.put(slot_, frames, batch.watermark);
  publish_report(batch);
  {
    const std::lock_guard lock(mutex_);
    report_.ended = true;
  }
  mailbox_.end(slot_);
  progress_.rest();
}

bool SourceWorker::step(DatagramBatch& batch, std::vector<CsiFrame>& frames, Duration timeout) {
  const Expected<void> read = source_->read(batch, timeout);
  if (!read) {
    batch.datagrams.clear();
    failure_ = read.error().message;
    return false;
  }
  if (batch.moved) {
    move(*batch.moved, batch, frames);
    return true;
  }
  for (DatagramTap* const tap : taps_) {
    tap->tap(batch.datagrams);
  }
  for (const Datagram& datagram : batch.datagrams) {
    receiver_.push(datagram, frames);
  }
  receiver_.advance(batch.watermark, frames);
  const Timestamp safe_time = receiver_.safe_time(batch.watermark);
  show(frames);
  publish_report(batch);
  progress_.rest();  // of a recording it waits for room
  mailbox_.put(slot_, frames, safe_time);
  progress_.beat();
  return !batch.ended;
}

void SourceWorker::move(std::uint64_t number,
                        const DatagramBatch& batch,
                        std::vector<CsiFrame>& frames) {
  for (DatagramTap* const tap : taps_) {
    tap->moved();
  }
  receiver_.flush(frames);
  show(frames);
  publish_report(batch);
  progress_.rest();  // it waits for the other sources and for what they have left
  mailbox_.put(slot_, frames, Timestamp::max());
  mailbox_.move(slot_, number);
  progress_.beat();
}

void SourceWorker::show(std::span<const CsiFrame> frames) {
  census_.add(frames);
  if (frame_tap_ != nullptr && !frames.empty()) {
    frame_tap_->tap(access_point_, frames);
  }
}

void SourceWorker::publish_report(const DatagramBatch& batch) {
  SourceCounters source = source_->counters();
  CsiReceiverCounters receiver = receiver_.counters();
  std::string error = failure_.empty() ? source_->trouble() : failure_;
  const std::lock_guard lock(mutex_);
  report_.source = std::move(source);
  report_.receiver = std::move(receiver);
  report_.frames = census_;
  report_.ended = batch.rests;
  report_.error = std::move(error);
  if (!batch.datagrams.empty()) {
    report_.last_datagram = batch.datagrams.back().time;
    report_.last_arrival = std::chrono::steady_clock::now();
  }
}

SourceReport SourceWorker::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

}  // namespace rayloc
