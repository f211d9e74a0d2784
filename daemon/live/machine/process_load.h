// ProcessLoad: the share of the available processor time that this process has used.
//
// Thread safety: one thread.
#pragma once

#include <chrono>

namespace rayloc {

class ProcessLoad {
 public:
  ProcessLoad();

  // Since the last call, 0 to 1; a call within kEvery of it returns the same value.
  double measure();
  static constexpr std::chrono::seconds kEvery{5};  // chosen: longer than a burst of work

 private:
  using Time = std::chrono::steady_clock::time_point;

  Time measured_;
  std::chrono::microseconds used_;
  double load_ = 0.0;
};

}  // namespace rayloc
