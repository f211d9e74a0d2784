// CrowdSender: one recorded walk as many devices would have sent it, to loopback ports in real
// time. Each has an address of its own and walks another part of the recording.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/recording.h"

namespace rayloc::bench {

struct Crowd {
  // [access point]: AX-CSI datagrams of a single transmitter.
  std::vector<test::Recording> recordings;
  std::vector<std::uint16_t> ports;  // [access point]
  int first = 0;                     // number of the first device
  int devices = 1;                   // with the first, below 65536
  Duration length{};                 // shorter than the recordings
};

// The address of device `number`: 02:52:4c:01:HIGH:LOW.
MacAddress crowd_address(int number);

class CrowdSender {
 public:
  // Throws std::runtime_error when a recording is empty, no AX-CSI or too short.
  explicit CrowdSender(Crowd crowd);
  ~CrowdSender();
  CrowdSender(const CrowdSender&) = delete;
  CrowdSender& operator=(const CrowdSender&) = delete;

  bool finished() const { return finished_; }
  std::uint64_t datagrams() const { return events_.size(); }
  // The largest delay of a datagram: if it is large, the machine has no time for this test.
  std::chrono::milliseconds latest() const { return std::chrono::milliseconds(latest_ms_); }

 private:
  struct Event {
    Duration after{};  // the start
    std::uint32_t datagram = 0;
    std::uint16_t access_point = 0;
    std::uint16_t device = 0;
  };
  void plan();
  void run();

  Crowd crowd_;
  std::vector<std::size_t> address_at_;  // [access point], in a datagram
  std::vector<Event> events_;            // in order of time
  std::atomic<bool> finished_ = false;
  std::atomic<bool> stopping_ = false;
  std::atomic<std::int64_t> latest_ms_ = 0;
  std::thread thread_;
};

}  // namespace rayloc::bench
