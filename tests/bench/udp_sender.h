// UdpFlood: a process that sends UDP datagrams to a loopback port at a steady rate, so that the
// receiver measured has its own processor.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayloc::bench {

struct Flood {
  std::uint16_t port = 0;
  double rate = 0;  // datagrams per second
  double seconds = 0;
  const std::vector<std::vector<std::byte>>* payloads = nullptr;  // over and over
};

class UdpFlood {
 public:
  explicit UdpFlood(const Flood& flood);
  ~UdpFlood();
  UdpFlood(const UdpFlood&) = delete;
  UdpFlood& operator=(const UdpFlood&) = delete;

  // Once it has sent everything: how many datagrams, and in which time.
  bool finished();
  std::uint64_t sent() const { return result_.sent; }
  double rate() const { return static_cast<double>(result_.sent) / result_.seconds; }

 private:
  struct Result {
    std::uint64_t sent = 0;
    double seconds = 1;
  };
  static Result send_all(const Flood& flood);

  pid_t process_ = -1;
  int pipe_ = -1;
  bool finished_ = false;
  Result result_;
};

}  // namespace rayloc::bench
