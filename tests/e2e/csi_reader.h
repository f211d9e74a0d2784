// CsiReader: a subscriber of CSI frames, on a separate thread. Heartbeats and the goodbye report
// the losses at the end.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/live/publish/subscriber.h"

namespace rayloc::e2e {

class CsiReader {
 public:
  explicit CsiReader(const std::string& endpoint);
  ~CsiReader();
  CsiReader(const CsiReader&) = delete;
  CsiReader& operator=(const CsiReader&) = delete;

  std::uint64_t messages() const { return messages_; }  // frames of CSI
  std::uint64_t lost() const { return lost_; }          // of them
  std::uint64_t others_lost() const { return others_lost_; }
  // Between arrival of a frame's first datagram and its publication, of the newest `count` [ms].
  double latency_ms(double quantile, std::size_t count) const;

 private:
  void run();

  Subscriber subscriber_;
  mutable std::mutex mutex_;
  std::vector<float> latencies_;  // guarded by mutex_; [ms]
  std::atomic<std::uint64_t> messages_ = 0;
  std::atomic<std::uint64_t> lost_ = 0;
  std::atomic<std::uint64_t> others_lost_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace rayloc::e2e
