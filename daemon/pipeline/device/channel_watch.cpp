#include "daemon/pipeline/device/channel_watch.h"

#include <utility>

namespace rayloc {
namespace {

constexpr std::size_t kDevices = 4;
constexpr std::size_t kAddedPerQuestion = 100;  // bursts: some seconds of some devices

}  // namespace

bool ChannelWatch::is_wanted() const {
  const std::lock_guard lock(mutex_);
  return wanted_ > 0;
}

void ChannelWatch::add(Sight sight) {
  auto added = std::make_shared<const Sight>(std::move(sight));
  const std::lock_guard lock(mutex_);
  wanted_ -= wanted_ > 0 ? 1U : 0U;
  sights_.remove_if([&](const auto& one) { return one->target == added->target; });
  sights_.push_front(std::move(added));
  if (sights_.size() > kDevices) {
    sights_.pop_back();
  }
}

std::vector<std::shared_ptr<const ChannelWatch::Sight>> ChannelWatch::ask() {
  const std::lock_guard lock(mutex_);
  if (wanted_ == 0) {
    sights_.clear();
  }
  wanted_ = kAddedPerQuestion;
  return {sights_.begin(), sights_.end()};
}

void ChannelWatch::clear() {
  const std::lock_guard lock(mutex_);
  sights_.clear();
}

}  // namespace rayloc
