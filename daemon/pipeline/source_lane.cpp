#include "daemon/pipeline/source_lane.h"

#include <utility>

namespace rayloc {

SourceLane::SourceLane(SourceInput input, FrameMailbox& mailbox, std::size_t slot)
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

bool SourceLane::step(Duration timeout) {
  progress_.beat();
  const Expected<void> read = source_->read(batch_, timeout);
  if (!read) {
    batch_.datagrams.clear();
    failure_ = read.error().message;
    return false;
  }
  if (batch_.moved) {
    move(*batch_.moved);
    return true;
  }
  for (DatagramTap* const tap : taps_) {
    tap->tap(batch_.datagrams);
    tap->advance(batch_.watermark);
  }
  stamps_.add(batch_.datagrams);
  for (const Datagram& datagram : batch_.datagrams) {
    receiver_.push(datagram, frames_);
  }
  receiver_.advance(batch_.watermark, frames_);
  const Timestamp safe_time = receiver_.safe_time(batch_.watermark);
  show();
  publish_report();
  progress_.rest();  // with a recording it waits for room
  mailbox_.put(slot_, frames_, safe_time);
  return !batch_.ended;
}

void SourceLane::finish() {
  progress_.beat();
  receiver_.flush(frames_);
  show();
  progress_.rest();
  mailbox_.put(slot_, frames_, batch_.watermark);
  publish_report();
  {
    const std::lock_guard lock(mutex_);
    report_.ended = true;
  }
  mailbox_.end(slot_);
  progress_.rest();
}

void SourceLane::move(std::uint64_t number) {
  for (DatagramTap* const tap : taps_) {
    tap->moved();
  }
  receiver_.flush(frames_);
  show();
  publish_report();
  progress_.rest();  // it waits for the other sources and for their remaining frames
  mailbox_.put(slot_, frames_, Timestamp::max());
  mailbox_.move(slot_, number);
  progress_.beat();
}

void SourceLane::show() {
  census_.add(frames_);
  stamps_.add(frames_);
  if (frame_tap_ != nullptr && !frames_.empty()) {
    frame_tap_->tap(access_point_, frames_);
  }
}

void SourceLane::publish_report() {
  SourceCounters source = source_->counters();
  CsiReceiverCounters receiver = receiver_.counters();
  std::string error = failure_.empty() ? source_->trouble() : failure_;
  const std::lock_guard lock(mutex_);
  report_.source = std::move(source);
  report_.receiver = std::move(receiver);
  report_.frames = census_;
  report_.stamps = stamps_.text();
  report_.ended = batch_.at_end;
  report_.error = std::move(error);
  if (!batch_.datagrams.empty()) {
    report_.last_datagram = batch_.datagrams.back().time;
    report_.last_arrival = std::chrono::steady_clock::now();
  }
}

SourceReport SourceLane::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

}  // namespace rayloc
