// ChainKeeper: the state of receive chains in the learners of the estimator's rooms: the same in
// all learners, stored in a file for the next program, and reported to the operator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/methods/device_capabilities.h"
#include "engine/base/expected.h"
#include "engine/monitor/calibration_monitor.h"
#include "engine/room/room_model.h"

namespace rayloc {

class ChainKeeper {
 public:
  struct Options {
    std::string read;   // file of the chains learned before; empty: none
    std::string write;  // file to be written; empty: none
  };
  explicit ChainKeeper(Options options) : options_(std::move(options)) {}

  // Restores the learners from the file. To be called before the first burst.
  void restore(const std::vector<ChainCapability*>& learners, const RoomModel& room);
  // Restores the learners from the state of a predecessor, without a report: it was reported then.
  // A learner that has restored evidence on the same unknown chains keeps it.
  void go_on(const std::vector<ChainState>& states, const std::vector<ChainCapability*>& learners);
  // `learner` may have new results: they are passed to the other learners and stored.
  void spread(const ChainCapability& learner,
              const std::vector<ChainCapability*>& learners,
              const RoomModel& room);
  void restart();  // restarts with the learners

  // Warnings about the access points whose chains are being learned anew.
  std::vector<CalibrationWarning> warnings(const RoomModel& room) const;
  // Progress of the chains being learned: the reason if no access point can be used.
  std::string reason(const RoomModel& room) const;
  // From any thread: the current states, and lines for the log since the last call.
  std::vector<ChainState> states() const;
  std::vector<std::string> notices();

  // Adds a line for the log.
  void notify(std::string line);

 private:
  // Writes the file, with the evidence of chains that are being learned.
  Expected<void> write(std::vector<ChainState> states,
                       const std::vector<ChainCapability*>& learners,
                       const RoomModel& room) const;
  void keep(std::vector<ChainState> states);

  Options options_;
  std::map<const ChainCapability*, std::uint64_t> seen_;  // ChainCapability::changes()
  std::map<const ChainCapability*, std::size_t> stored_;  // bursts while learning, when written
  bool has_failed_ = false;                               // the last write
  mutable std::mutex mutex_;
  std::vector<ChainState> known_;     // guarded by mutex_; written by the estimation thread
  std::vector<std::string> notices_;  // guarded by mutex_
};

}  // namespace rayloc
