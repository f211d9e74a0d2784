// Shutdown: the steps of a stop, one after another, each with a deadline. A step that misses its
// deadline is abandoned on its thread, and the next one begins: one disk or one estimate that does
// not return blocks no other step.
//
//   Shutdown shutdown;
//   if (!shutdown.run("estimation", deadline, [this] { pipeline_->stop(); })) { ... }
//   shutdown.run("recorder ap1", later, [this] { recorder_->finish(); });
//   if (!shutdown.hung().empty()) { ... the process must end without joining them ... }
//
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace rayloc {

class Shutdown {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Minimum time of every step, however late the earlier ones were.
  static constexpr std::chrono::milliseconds kMinTime{100};

  Shutdown() = default;
  // Abandons steps that have not returned: the objects that they use must outlive the process.
  ~Shutdown();
  Shutdown(const Shutdown&) = delete;
  Shutdown& operator=(const Shutdown&) = delete;

  // Begins a step in parallel to the following ones; wait_for() reports if it has returned.
  void begin(const std::string& name, std::function<void()> step);
  // False when `step` has not returned by `deadline`, nor after kMinTime. Rethrows its exception.
  bool run(const std::string& name, Time deadline, std::function<void()> step);
  // Waits for a late step until `deadline`; false when it has not returned by then. Rethrows its
  // exception.
  bool wait_for(const std::string& name, Time deadline);
  // Joins the late steps that have returned meanwhile; true if none is left. Does not wait, and
  // rethrows nothing: take_failures().
  bool all_returned();
  struct Failure {
    std::string step;
    std::string reason;
  };
  // Steps that all_returned() has joined and that ended with an exception; each once.
  std::vector<Failure> take_failures() { return std::exchange(failures_, {}); }
  // Steps that have not returned so far, in their order.
  std::vector<std::string> hung() const;

 private:
  struct Step {
    std::string name;
    std::future<void> done;
    std::thread thread;
  };
  std::vector<Step> late_;
  std::vector<Failure> failures_;
};

}  // namespace rayloc
