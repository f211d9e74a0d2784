// ChainKeeper: what the learners of the estimator's rooms know of receive chains: the same in all,
// kept in a file for the next program, and told to people.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "engine/chains/chain_learner.h"
#include "engine/monitor/calibration_monitor.h"
#include "engine/room/room_model.h"

namespace rayloc {

class ChainKeeper {
 public:
  struct Options {
    std::string read;   // the file of what was learned before; empty: nothing
    std::string write;  // where it is kept; empty: nowhere
  };
  explicit ChainKeeper(Options options) : options_(std::move(options)) {}

  // Before the first burst.
  void restore(const std::vector<ChainLearner*>& learners, const RoomModel& room);
  // The same, of what a predecessor knew. Nobody is told: it was.
  void go_on(const std::vector<ChainState>& states, const std::vector<ChainLearner*>& learners);
  // `learner` may have found out something: the others take it, and it is kept.
  void spread(const ChainLearner& learner,
              const std::vector<ChainLearner*>& learners,
              const RoomModel& room);
  void restart();  // with the learners

  // Of the access points that are learned anew.
  std::vector<CalibrationWarning> warnings(const RoomModel& room) const;
  // Why none of the access points can be believed.
  std::string reason(const RoomModel& room) const;
  // From any thread: what is known now, and lines for the log since the last call.
  std::vector<ChainState> states() const;
  std::vector<std::string> news();

 private:
  void tell(std::string line);
  void keep(std::vector<ChainState> states);

  Options options_;
  std::map<const ChainLearner*, std::uint64_t> seen_;  // ChainLearner::changes()
  mutable std::mutex mutex_;
  std::vector<ChainState> known_;  // guarded by mutex_; written by the estimation thread
  std::vector<std::string> news_;  // guarded by mutex_
};

}  // namespace rayloc
