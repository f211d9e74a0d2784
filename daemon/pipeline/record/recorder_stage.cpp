#include "daemon/pipeline/record/recorder_stage.h"

#include <optional>
#include <utility>

#include "daemon/pipeline/shared/receiver_pool.h"
#include "engine/base/spare_capacity.h"

namespace rayloc {
namespace {

constexpr std::size_t kWakeBytes = std::size_t{1} << 20U;

}  // namespace

void RecorderStage::Buffer::clear() {
  clear_without_spare(entries);
  clear_without_spare(bytes);
  dropped = 0;
}

RecorderStage::RecorderStage(std::unique_ptr<RotatingRecorder> recorder,
                             ReceiverPool* writers,
                             std::size_t buffer_bytes)
    : buffer_bytes_(buffer_bytes), recorder_(std::move(recorder)), writers_(writers) {
  counters_.files = recorder_->counters();
  if (writers_ != nullptr) {
    writers_->add(*this);
  } else {
    thread_ = std::thread([this] { run(); });
  }
}

RecorderStage::~RecorderStage() { finish(); }

void RecorderStage::tap(std::span<const Datagram> datagrams) {
  const std::lock_guard lock(mutex_);
  for (const Datagram& datagram : datagrams) {
    ++counters_.tapped;
    // After a drop the gap continues until the buffer is taken: it has one mark.
    if (waiting_.dropped > 0 || waiting_.bytes.size() + datagram.payload.size() > buffer_bytes_) {
      ++counters_.dropped;
      waiting_.dropped_from = waiting_.dropped == 0 ? datagram.time : waiting_.dropped_from;
      waiting_.dropped_to = datagram.time;
      ++waiting_.dropped;
      continue;
    }
    waiting_.entries.push_back({datagram.time, datagram.address, datagram.payload.size()});
    waiting_.bytes.insert(waiting_.bytes.end(), datagram.payload.begin(), datagram.payload.end());
    ++counters_.waiting;
  }
  if (waiting_.bytes.size() >= kWakeBytes) {
    wake_.notify_one();
  }
}

void RecorderStage::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  if (writers_ != nullptr) {
    writers_->wait_for_end(*this);
  } else if (thread_.joinable()) {
    thread_.join();
  }
}

void RecorderStage::run() {
  do {
    progress_.beat();
    std::unique_lock lock(mutex_);
    wake_.wait_for(
        lock, kWriteInterval, [&] { return finishing_ || waiting_.bytes.size() >= kWakeBytes; });
  } while (write_waiting());
  progress_.rest();
}

// Between its steps it waits for others.
bool RecorderStage::read_once() {
  progress_.beat();
  const bool continues = write_waiting();
  progress_.rest();
  return continues;
}

// False when it has written everything, and has closed the file.
bool RecorderStage::write_waiting() {
  std::optional<RecordingLimits> limits;
  bool finishing = false;
  {
    const std::lock_guard lock(mutex_);
    std::swap(writing_, waiting_);
    std::swap(limits, limits_);
    finishing = finishing_;
  }
  if (limits) {
    recorder_->set_limits(*limits);
  }
  write(writing_);
  writing_.clear();
  if (finishing) {
    recorder_->close();
    const std::lock_guard lock(mutex_);
    counters_.files = recorder_->counters();
  }
  return !finishing;
}

void RecorderStage::write(const Buffer& buffer) {
  std::vector<Datagram> datagrams;
  datagrams.reserve(buffer.entries.size());
  std::span<const std::byte> bytes = buffer.bytes;
  for (const Buffer::Entry& entry : buffer.entries) {
    datagrams.push_back({entry.time, entry.address, bytes.first(entry.size)});
    bytes = bytes.subspan(entry.size);
  }
  const std::uint64_t written_before = recorder_->counters().written;
  recorder_->write(datagrams);
  if (buffer.dropped > 0) {
    recorder_->note_dropped(buffer.dropped, "buffer_full", buffer.dropped_from, buffer.dropped_to);
  }
  const std::uint64_t written = recorder_->counters().written - written_before;
  const std::lock_guard lock(mutex_);
  counters_.waiting -= datagrams.size();
  counters_.written += written;
  counters_.dropped += datagrams.size() - written;
  counters_.files = recorder_->counters();
}

void RecorderStage::set_limits(const RecordingLimits& limits) {
  const std::lock_guard lock(mutex_);
  limits_ = limits;
}

RecorderStageCounters RecorderStage::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
