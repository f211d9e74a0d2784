// TopModel: the data that `rayloc top` shows, collected from received messages.
//
// Two clocks: the steady one of this machine, passed in, for rates and for the
// time since an arrival; and the daemon's, read from the messages, for the age
// of their content. The two machines need not agree on the time of day.
//
// Memory is bounded: a target is removed after kForgetAfter without a
// message, and beyond kMaxTargets the one that has been silent longest.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/messages/gap_detector.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::cli {

class TopModel {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr auto kForgetAfter = std::chrono::minutes(5);
  static constexpr std::size_t kMaxTargets = 1024;
  static constexpr auto kRateWindow = std::chrono::seconds(5);

  // In order of arrival. `from_snapshot`: an earlier message, which does not count for rates.
  void add(const std::string& topic,
           const v1::Envelope& envelope,
           Clock::time_point now,
           bool from_snapshot = false);

  // Locations of one kind for a target.
  struct Stream {
    v1::Location last;
    Timestamp sent;                      // of the last, by the daemon's clock
    std::deque<Clock::time_point> came;  // arrivals, within kRateWindow of the last
  };
  struct Target {
    std::optional<Stream> snapshot;
    std::optional<Stream> filtered;
    Clock::time_point received;
  };
  // Stream that is shown: filtered, unless only snapshots came for 5 s.
  static const Stream& shown(const Target& target);

  const std::map<std::string, Target>& targets() const { return targets_; }  // by topic component
  const std::map<std::string, v1::ZoneEvent>& zones() const {
    return zones_;
  }  // last event of each
  // Zones of a target, by their last events: the probabilities in its own
  // message have not passed through the hysteresis, and would contradict them.
  std::vector<std::string> zones_of(const std::string& component) const;
  const std::map<std::string, v1::SourceState>& sources() const {
    return sources_;
  }  // last message of each; the heartbeat's counters are newer
  const std::optional<v1::Heartbeat>& heartbeat() const { return heartbeat_; }
  const std::optional<v1::Goodbye>& goodbye() const { return goodbye_; }  // until it is back
  std::uint64_t heartbeats() const { return heartbeats_; }
  std::uint64_t lost() const { return gaps_.lost(); }  // messages in transit to us
  std::uint64_t restarts() const { return gaps_.restarts(); }

  // Present time of the daemon's clock, as far as the messages state it.
  Timestamp daemon_time(Clock::time_point now) const;
  // Time since the last heartbeat; nothing before the first.
  std::optional<Clock::duration> silence(Clock::time_point now) const;
  // Messages per second.
  static double rate(const Stream& stream, Clock::time_point now);
  // Datagrams per second between the last two heartbeats; nothing before there are two.
  std::optional<double> datagram_rate(const std::string& access_point) const;

 private:
  void add_location(const v1::Envelope& envelope, Clock::time_point now, bool from_snapshot);
  void add_heartbeat(const v1::Heartbeat& heartbeat, Clock::time_point now);
  void forget_old(Clock::time_point now);

  GapDetector gaps_;
  std::uint64_t epoch_ = 0;
  std::map<std::string, Target> targets_;
  std::map<std::string, v1::ZoneEvent> zones_;
  std::map<std::string, v1::SourceState> sources_;
  std::optional<v1::Heartbeat> heartbeat_;
  std::optional<v1::Heartbeat> previous_;  // of the same start of the daemon
  std::optional<v1::Goodbye> goodbye_;
  Clock::time_point heartbeat_came_;
  std::uint64_t heartbeats_ = 0;
  Timestamp newest_sent_;
  Clock::time_point newest_came_;
};

}  // namespace rayloc::cli
