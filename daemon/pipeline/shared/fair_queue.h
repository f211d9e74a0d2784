// FairQueue: the order in which members with work take turns. Next is the member that has used the
// least so far; of equal ones, the first that was added. A member that had no work for a while gets
// no credit for that: it continues from the use of the member that was served last.
//
// A member has one place, however much work it has. Thread safety: none.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "engine/base/timestamp.h"

namespace rayloc {

class FairQueue {
 public:
  // Use by a member so far, in time of one thread.
  struct Share {
    Duration used{};
  };

  // REQUIRES: it is not in the queue, and outlives its place there.
  void push(Share& member);
  // Removes the next member; null: none has work.
  Share* pop();
  bool empty() const { return waiting_.empty(); }

 private:
  Duration served_{};  // use of the member that was served last
  std::uint64_t pushed_ = 0;
  std::map<std::pair<Duration, std::uint64_t>, Share*> waiting_;  // by use, then by arrival
};

}  // namespace rayloc
