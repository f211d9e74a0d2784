// Saturation: which queues have overflowed lately, as a reason against being ready: what is
// published then is late or made of less than what came. And, as a warning, that more bursts come
// than can be explained: positions are right then, and fewer. From the counters of the heartbeat.
//
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc {

// "more bursts come than this machine can explain: CONSEQUENCE; ...": and what to do.
std::string overload_text(const std::string& consequence);

class Saturation {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // How long an overflow speaks against being ready.
  static constexpr std::chrono::seconds kLately{10};

  // To be called every second or so with the counters as they are.
  void look(const v1::Heartbeat& heartbeat, Time now);
  // "source ap1: frames were dropped in the last 10 s: ..."; as of the last look.
  std::vector<std::string> reasons() const;
  // The same of bursts: what happens to them, to how many, and what to do.
  std::vector<std::string> warnings() const;

 private:
  struct Queue {
    std::uint64_t lost = 0;
    Time last_loss;
    bool lately = false;
  };
  using Queues = std::map<std::string, Queue>;  // by what is said of them
  static void compare(const std::string& reason, std::uint64_t lost, Time now, Queues& queues);
  static std::vector<std::string> lately(const Queues& queues);

  // Counters of bursts at one look.
  struct Bursts {
    Time time;
    std::uint64_t explained = 0;
    std::uint64_t lost = 0;
  };
  double explained_share() const;

  Queues queues_;
  Queues bursts_;
  std::deque<Bursts> looks_;  // of the last kLately, and one before
};

}  // namespace rayloc
