// InterfaceFilter: accepts the traffic of one interface, given by name. Its kernel index changes
// when the interface is removed and created again (a USB adapter, a VLAN, a bridge): on another
// index the name is resolved again, at most once a second, so that a flood on a forbidden interface
// costs little.
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
  // The current index of an interface, 0 if none has that name.
  using LookUp = std::function<unsigned(const std::string& name)>;
  static constexpr std::chrono::seconds kLookUpInterval{1};

  // An empty name: every interface.
  explicit InterfaceFilter(std::string name);
  // For tests.
  InterfaceFilter(std::string name, LookUp look_up, std::function<Time()> now);

  // Returns true if the interface existed when its name was last resolved.
  bool exists() const { return name_.empty() || index_ != 0; }
  bool admits(unsigned index);

 private:
  const std::string name_;
  const LookUp look_up_;
  const std::function<Time()> now_;
  unsigned index_;  // 0: no such interface
  Time looked_up_;
};

}  // namespace rayloc
