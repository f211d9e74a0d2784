#include "daemon/live/cluster/fill_queue.h"

#include <utility>

namespace rayloc {

void FillQueue::add(const Batch& batch) {
  Waiting one{batch.number, std::make_shared<const std::string>(encode(batch)), counts_of(batch)};
  if (one.counts.empty()) {
    return;  // it only reported progress of its node, which is obsolete
  }
  bytes_ += one.bytes->size();
  for (const auto& [access_point, count] : one.counts) {
    waiting_[access_point] += count;
  }
  batches_.push_back(std::move(one));
  while (bytes_ > limits_.bytes && !batches_.empty()) {
    take_out_first(nullptr);
  }
}

std::optional<FillQueue::Ready> FillQueue::next(Time now) {
  if (batches_.empty() || (sent_ && now - *sent_ < limits_.patience)) {
    return std::nullopt;
  }
  sent_ = now;
  return Ready{batches_.front().number, batches_.front().bytes};
}

void FillQueue::acknowledged(std::uint64_t number) {
  if (!batches_.empty() && batches_.front().number == number) {
    take_out_first(&filled_);
  }
}

// `to`: counts that receive its datagrams; null: they are in the recordings alone.
void FillQueue::take_out_first(Counts* to) {
  Waiting& first = batches_.front();
  bytes_ -= first.bytes->size();
  for (const auto& [access_point, count] : first.counts) {
    waiting_[access_point] -= count;
    if (to != nullptr) {
      (*to)[access_point] += count;
    }
  }
  batches_.pop_front();
  sent_.reset();
}

}  // namespace rayloc
