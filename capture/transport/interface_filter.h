// InterfaceFilter: what arrived on one interface, that is named. The number by which the kernel
// calls it changes when it is taken away and made again (a USB adapter, a VLAN, a bridge): on
// another number the name is looked up again, at most once a second, so that a flood on a forbidden
// interface costs nothing.
//
//   InterfaceFilter filter("br0");
//   if (!filter.admits(pktinfo.ipi_ifindex)) { ... rejected ... }
//
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace rayloc {

class InterfaceFilter {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // The number of an interface now, 0 when there is none of that name.
  using LookUp = std::function<unsigned(const std::string& name)>;
  static constexpr std::chrono::seconds kLookUpInterval{1};

  // An empty name: every interface.
  explicit InterfaceFilter(std::string name);
  // For tests.
  InterfaceFilter(std::string name, LookUp look_up, std::function<Time()> now);

  // Whether there was such an interface when it was last looked up.
  bool exists() const { return name_.empty() || index_ != 0; }
  bool admits(unsigned index);

 private:
  const std::string name_;
  const LookUp look_up_;
  const std::function<Time()> now_;
  unsigned index_;  // 0: there is none
  Time looked_up_;
};

}  // namespace rayloc
