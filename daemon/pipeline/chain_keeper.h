// ChainKeeper: what the learners of the estimator's rooms know of receive chains: the same in all,
// kept in a file for the next program, and told to people.
#pragma once

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
  // `learner` may have found out something: the others take it, and it is kept.
  void spread(const ChainLearner& learner,
              const std::vector<ChainLearner*>& learners,
              const RoomModel& room);
  void restart() { known_.clear(); }  // with the learners

  // Of the access points that are learned anew.
  std::vector<CalibrationWarning> warnings(const RoomModel& room) const;
  // Why none of the access points can be believed.
  std::string reason(const RoomModel& room) const;
  // Lines for the log since the last call. From any thread.
  std::vector<std::string> news();

 private:
  void tell(std::string line);

  Options options_;
  std::vector<ChainState> known_;
  std::mutex mutex_;
  std::vector<std::string> news_;  // guarded by mutex_
};

}  // namespace rayloc
