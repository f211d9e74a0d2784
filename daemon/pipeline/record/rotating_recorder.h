// RotatingRecorder: the recordings of one source, one file after the other, within limits.
//
// A file is closed at a maximum length or age: synced to the disk, then renamed without
// kPartSuffix. The oldest recordings of the folder are deleted when all together exceed the limit.
// With too little room on the disk nothing is recorded until there is room again. All unrecorded
// data are counted, and marked in the file at their position (capture/record/recording_gap.h).
//
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/record/pcap_recorder.h"
#include "capture/record/recording_gap.h"
#include "capture/transport/datagram.h"
#include "engine/base/expected.h"

namespace rayloc {

// Limits that a reload may change.
struct RecordingLimits {
  std::uint64_t rotate_bytes = std::uint64_t{256} << 20U;        // a longer file is closed
  std::chrono::nanoseconds rotate_every{std::chrono::hours(1)};  // an older one is closed
  std::uint64_t max_total_bytes = std::uint64_t{10} << 30U;      // of all recordings in the folder
  std::uint64_t min_free_bytes = std::uint64_t{512} << 20U;  // of the disk, below which it stops
};

struct RotatingRecorderOptions {
  std::filesystem::path folder;
  std::string name;  // the files are NAME-20261121T140509Z.pcap
  RecordingLimits limits;
  // For names and marks: the machine's clock; and the monotonic clock. Replaced in tests.
  std::function<Timestamp()> now;
  std::function<std::chrono::steady_clock::time_point()> steady = std::chrono::steady_clock::now;
  std::function<std::uint64_t()> free_bytes;  // free_disk_bytes(folder) when empty
};

// given = written + lost.
struct RotatingRecorderCounters {
  std::uint64_t given = 0;
  std::uint64_t written = 0;
  std::uint64_t lost = 0;     // not recorded: no room, or the disk failed
  std::uint64_t bytes = 0;    // written, headers included
  std::uint64_t files = 0;    // closed
  std::uint64_t removed = 0;  // recordings that were deleted
  std::uint64_t gaps = 0;     // marked in the files
  std::uint64_t stops = 0;    // events of too little room
  bool stopped = false;       // current state
  std::string error;          // current error of the disk; empty if there is none
};

class RotatingRecorder {
 public:
  // Makes the folder, and opens a file. An obstacle (too little room, a folder that is not
  // writable) is counted and reported as later (counters().error), and retried every second: the
  // caller may continue without recording.
  explicit RotatingRecorder(RotatingRecorderOptions options);
  // Closes the file.
  ~RotatingRecorder();
  RotatingRecorder(const RotatingRecorder&) = delete;
  RotatingRecorder& operator=(const RotatingRecorder&) = delete;

  // The whole batch is recorded or lost. To be called some ten times a second, with an empty batch
  // when no data came.
  void write(std::span<const Datagram> batch);
  // Datagrams that an earlier stage had to drop: the next batch is written with their mark. They
  // are not part of its counters.
  void note_dropped(std::uint64_t datagrams,
                    const std::string& reason,
                    Timestamp from,
                    Timestamp to);

  // Marks missing datagrams, closes the file and gives it its name. No write may follow.
  void close();

  void set_limits(const RecordingLimits& limits) { options_.limits = limits; }
  const RotatingRecorderCounters& counters() const { return counters_; }

 private:
  using Debounce = std::chrono::steady_clock::time_point;

  void keep_house();
  void check_disk();
  void open_first_file();
  void rotate();
  Expected<void> open_file();
  // REQUIRES: there is a file.
  Expected<void> append(std::span<const Datagram> batch);
  void lose(std::span<const Datagram> batch, const std::string& reason);
  void mark_gaps(std::vector<Datagram>& batch,
                 std::vector<std::string>& texts,
                 Timestamp time) const;
  void name_finished(const std::string& part);

  RotatingRecorderOptions options_;
  std::optional<PcapRecorder> recorder_;  // empty while no file could be opened
  std::uint64_t records_ = 0;             // in the file
  std::vector<RecordingGap> gaps_;        // without a mark in a file yet
  Timestamp last_{};                      // time of the last datagram written
  Debounce opened_;                       // the file
  Debounce checked_;                      // last check of the disk
  Debounce tidied_;                       // last clean-up of the folder
  Debounce rotate_next_{};                // earliest next attempt: the last one failed
  std::string rotate_error_;              // of that attempt
  std::string name_error_;                // reason why the previous file has not got its name
  std::uint64_t synced_bytes_ = 0;        // of the file, as of tidied_
  RotatingRecorderCounters counters_;
};

}  // namespace rayloc
