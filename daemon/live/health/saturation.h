// Saturation: queues that have overflowed lately, as a reason against readiness: published data are
// then late or use only part of the input. Also, as a warning, more bursts than can be processed:
// positions are then correct, but fewer. From the counters of the heartbeat.
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

// "more bursts come than this machine can explain: CONSEQUENCE; ...": and the remedy.
std::string overload_text(const std::string& consequence);

class Saturation {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // Time for which an overflow counts against readiness.
  static constexpr std::chrono::seconds kLately{10};

  // To be called about every second with the current counters.
  void check(const v1::Heartbeat& heartbeat, Time now);
  // "source ap1: frames were dropped in the last 10 s: ..."; as of the last call of check().
  std::vector<std::string> reasons() const;
  // The same for bursts: the consequence, the share of bursts, the rates by rank, and the remedy.
  std::vector<std::string> warnings() const;
  // True if warnings() became empty at the last call of check().
  bool has_recovered() const { return has_recovered_; }

 private:
  struct Queue {
    std::uint64_t lost = 0;
    Time last_loss;
    bool lately = false;
  };
  using Queues = std::map<std::string, Queue>;  // by their text
  static void compare(const std::string& reason, std::uint64_t lost, Time now, Queues& queues);
  static std::vector<std::string> lately(const Queues& queues);

  // The counters at one call of check().
  struct Sample {
    Time time;
    v1::EstimationCounters counters;
  };
  double explained_share() const;
  std::string rates() const;

  Queues queues_;
  Queues bursts_;
  bool has_recovered_ = false;
  std::deque<Sample> samples_;  // of the last kLately, and one before
};

}  // namespace rayloc
