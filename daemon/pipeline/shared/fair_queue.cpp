#include "daemon/pipeline/shared/fair_queue.h"

#include <algorithm>

namespace rayloc {

void FairQueue::push(Share& member) {
  member.used = std::max(member.used, served_);
  waiting_.emplace(std::pair(member.used, ++pushed_), &member);
}

FairQueue::Share* FairQueue::pop() {
  if (waiting_.empty()) {
    return nullptr;
  }
  Share* const next = waiting_.begin()->second;
  waiting_.erase(waiting_.begin());
  served_ = next->used;
  return next;
}

}  // namespace rayloc
