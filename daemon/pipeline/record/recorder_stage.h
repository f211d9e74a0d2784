// RecorderStage: writes the datagrams of one source to recordings, on a separate thread, so that a
// slow disk never delays the receiving thread. The recorders of a process may share threads.
//
// Between the two is a bounded buffer; when the disk cannot keep up, the newest datagrams are
// dropped, counted, and marked in the recording. A batch is written every 100 ms, or with a
// thread of its own as soon as 1 MiB waits; on shared threads later while the disk delays other
// recorders.
//
// Thread safety: tap() from one thread; counters(), set_limits() from any.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "capture/transport/datagram.h"
#include "daemon/pipeline/record/rotating_recorder.h"
#include "daemon/pipeline/shared/polled_reader.h"
#include "daemon/pipeline/source_worker.h"
#include "engine/base/expected.h"

namespace rayloc {

class ReceiverPool;

// tapped = written + dropped + waiting.
struct RecorderStageCounters {
  std::uint64_t tapped = 0;
  std::uint64_t written = 0;
  std::uint64_t dropped = 0;  // buffer full, no room, or the file could not be written
  std::uint64_t waiting = 0;
  RotatingRecorderCounters files;  // as of the last batch
};

class RecorderStage : public DatagramTap, private PolledReader {
 public:
  static constexpr std::size_t kDefaultBufferBytes = std::size_t{32} << 20U;
  static constexpr std::chrono::milliseconds kWriteInterval{100};

  // `writers`: threads that write, with ticks of kWriteInterval; outlives this. Null: a thread of
  // its own.
  explicit RecorderStage(std::unique_ptr<RotatingRecorder> recorder,
                         ReceiverPool* writers = nullptr,
                         std::size_t buffer_bytes = kDefaultBufferBytes);
  ~RecorderStage() override;
  RecorderStage(const RecorderStage&) = delete;
  RecorderStage& operator=(const RecorderStage&) = delete;

  void tap(std::span<const Datagram> datagrams) override;

  // Writes waiting datagrams, closes the file, ends the thread; tap() must not be called again.
  void finish();

  // Applies from the next batch on.
  void set_limits(const RecordingLimits& limits);
  RecorderStageCounters counters() const;
  const StageProgress& progress() const { return progress_; }
  bool has_shared_thread() const { return writers_ != nullptr; }

 private:
  // Datagrams with contiguous payloads in `bytes`.
  struct Buffer {
    struct Entry {
      Timestamp time;
      DatagramAddress address;
      std::size_t size;
    };
    std::vector<Entry> entries;
    std::vector<std::byte> bytes;
    // After the entries, for lack of room.
    std::uint64_t dropped = 0;
    Timestamp dropped_from{};
    Timestamp dropped_to{};
    void clear();
  };

  void run();
  int descriptor() const override { return -1; }
  bool read_once() override;
  bool may_have_more() const override { return false; }
  bool write_waiting();
  void write(const Buffer& buffer);

  const std::size_t buffer_bytes_;
  StageProgress progress_;
  std::unique_ptr<RotatingRecorder> recorder_;  // used by the thread alone, as writing_
  Buffer writing_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Buffer waiting_;                         // guarded by mutex_
  RecorderStageCounters counters_;         // guarded by mutex_
  std::optional<RecordingLimits> limits_;  // guarded by mutex_; new ones
  bool finishing_ = false;                 // guarded by mutex_
  ReceiverPool* const writers_;            // null: a thread of its own
  std::thread thread_;
};

}  // namespace rayloc
