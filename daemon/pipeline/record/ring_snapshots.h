// RingSnapshots: writes the content of the rings of all sources to recordings, on request.
//
// One file per source, AP-snapshot-20261121T140509Z.pcap, by a thread that runs while it writes:
// the requester never waits for a disk, which may be the faulty part, and no stage has to make
// progress for it. They are recordings like others: bounded in total, repaired after a crash.
//
// Thread safety: any thread, unless stated otherwise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/record/datagram_ring.h"
#include "engine/base/expected.h"

namespace rayloc {

struct RingSnapshotCounters {
  std::uint64_t files = 0;   // written
  std::uint64_t failed = 0;  // files that could not be written
};

class RingSnapshots {
 public:
  struct Source {
    std::string access_point;
    DatagramRing* ring = nullptr;  // outlives this
  };
  struct Limits {
    std::uint64_t max_total_bytes = 0;  // of the recordings in the folder
    std::uint64_t min_free_bytes = 0;   // of its disk, not used by a snapshot
  };

  RingSnapshots(std::vector<Source> sources, std::filesystem::path folder, const Limits& limits);
  ~RingSnapshots();
  RingSnapshots(const RingSnapshots&) = delete;
  RingSnapshots& operator=(const RingSnapshots&) = delete;

  // Takes the current content of the rings, and begins to write it; returns the paths of the files.
  // kUnavailable while another is being written, and when the rings are empty.
  Expected<std::vector<std::string>> request();

  // Completes the current snapshot, and takes no further request; done by the destructor as well.
  // One thread.
  void finish();

  // Apply from the next file on.
  void set_limits(const Limits& limits);

  RingSnapshotCounters counters() const;
  // Written and failed files since the last call; one line each, for the log.
  std::vector<std::string> notices();

 private:
  struct File {
    std::string path;
    std::vector<std::shared_ptr<const DatagramRing::Piece>> pieces;
  };
  void run(const std::vector<File>& files);
  void write(const File& file);
  Expected<std::uint64_t> write_file(const File& file, std::uint64_t min_free_bytes) const;

  const std::vector<Source> sources_;
  const std::filesystem::path folder_;
  mutable std::mutex mutex_;
  Limits limits_;                     // guarded by mutex_
  bool writing_ = false;              // guarded by mutex_
  bool ending_ = false;               // guarded by mutex_
  RingSnapshotCounters counters_;     // guarded by mutex_
  std::vector<std::string> notices_;  // guarded by mutex_
  std::thread thread_;                // of the last snapshot; guarded by mutex_ until ending_
};

}  // namespace rayloc
