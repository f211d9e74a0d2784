#include "daemon/pipeline/recorder_stage.h"

#include <utility>

namespace rayloc {
namespace {

constexpr auto kWriteInterval = std::chrono::milliseconds(100);
constexpr std::size_t kWakeBytes = std::size_t{1} << 20U;

}  // namespace

RecorderStage::RecorderStage(PcapRecorder recorder, std::size_t buffer_bytes)
    : buffer_bytes_(buffer_bytes), recorder_(std::move(recorder)), thread_([this] { run(); }) {}

RecorderStage::~RecorderStage() { finish(); }

void RecorderStage::tap(std::span<const Datagram> datagrams) {
  const std::lock_guard lock(mutex_);
  for (const Datagram& datagram : datagrams) {
    ++counters_.tapped;
    if (waiting_.bytes.size() + datagram.payload.size() > buffer_bytes_) {
      ++counters_.dropped;
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
  if (thread_.joinable()) {
    thread_.join();
  }
}

void RecorderStage::run() {
  Buffer writing;
  bool finishing = false;
  while (!finishing) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(
          lock, kWriteInterval, [&] { return finishing_ || waiting_.bytes.size() >= kWakeBytes; });
      std::swap(writing, waiting_);
      finishing = finishing_;
    }
    write(writing);
    writing.entries.clear();
    writing.bytes.clear();
  }
}

void RecorderStage::write(const Buffer& buffer) {
  if (buffer.entries.empty()) {
    return;
  }
  std::vector<Datagram> datagrams;
  datagrams.reserve(buffer.entries.size());
  std::span<const std::byte> bytes = buffer.bytes;
  for (const Buffer::Entry& entry : buffer.entries) {
    datagrams.push_back({entry.time, entry.address, bytes.first(entry.size)});
    bytes = bytes.subspan(entry.size);
  }
  const Expected<void> written = recorder_.write(datagrams);
  const std::lock_guard lock(mutex_);
  counters_.waiting -= datagrams.size();
  if (written) {
    counters_.written += datagrams.size();
  } else {
    counters_.dropped += datagrams.size();
    counters_.error = written.error().message;
  }
}

RecorderStageCounters RecorderStage::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
