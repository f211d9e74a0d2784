// ProcessLoad: how much of the time of the processors that this process may use it has used.
//
// Thread safety: one thread.
#pragma once

#include <chrono>

namespace rayloc {

class ProcessLoad {
 public:
  ProcessLoad();

  // Since the look before, 0 to 1; a look within kEvery of it says the same again.
  double look();
  static constexpr std::chrono::seconds kEvery{5};  // chosen: longer than a burst of work

 private:
  using Time = std::chrono::steady_clock::time_point;

  Time looked_;
  std::chrono::microseconds used_;
  double load_ = 0.0;
};

}  // namespace rayloc
