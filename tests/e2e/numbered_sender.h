// NumberedSender: datagrams with the numbers 0, 1, 2 ... to a UDP port on loopback, so that a
// recording of them shows what is missing. No CSI: the daemon records and rejects them.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace rayloc::e2e {

class NumberedSender {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit NumberedSender(std::uint16_t port);
  ~NumberedSender();
  NumberedSender(const NumberedSender&) = delete;
  NumberedSender& operator=(const NumberedSender&) = delete;

  // The next `count` at once.
  void send(int count);
  // So many a millisecond, from a thread, until end().
  void begin(int per_millisecond);
  void end();

  std::uint64_t sent() const { return sent_; }
  // When that one was sent; after end().
  Time time_of(std::uint64_t number) const { return times_.at(number); }

 private:
  int socket_;
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<bool> ending_{false};
  std::vector<Time> times_;
  std::thread thread_;
};

// The contents of a folder's recordings, all files in the order of their names.
struct NumberedRecording {
  std::vector<std::uint64_t> numbers;
  std::uint64_t gap_marks = 0;
  std::uint64_t unrecorded = 0;  // by the gap marks
  std::string trouble;           // an error of reading, or a torn record
  std::size_t files = 0;
  // 0, 1, 2 ... without a hole.
  bool is_prefix() const;
};
// Reads the files whose names end in `suffix`.
NumberedRecording read_numbered(const std::filesystem::path& folder,
                                const std::string& suffix = ".pcap");

}  // namespace rayloc::e2e
