#include "capture/transport/interface_filter.h"

#include <net/if.h>

#include <utility>

namespace rayloc {

InterfaceFilter::InterfaceFilter(std::string name)
    : InterfaceFilter(
          std::move(name),
          [](const std::string& wanted) { return if_nametoindex(wanted.c_str()); },
          std::chrono::steady_clock::now) {}

InterfaceFilter::InterfaceFilter(std::string name, LookUp look_up, std::function<Time()> now)
    : name_(std::move(name)),
      look_up_(std::move(look_up)),
      now_(std::move(now)),
      index_(name_.empty() ? 0 : look_up_(name_)),
      looked_up_(now_()) {}

bool InterfaceFilter::admits(unsigned index) {
  if (name_.empty() || index == index_) {
    return true;
  }
  const Time now = now_();
  if (now - looked_up_ < kLookUpInterval) {
    return false;
  }
  looked_up_ = now;
  index_ = look_up_(name_);
  return index == index_;
}

}  // namespace rayloc
