// StageProgress: shows whether the thread of a stage makes progress; input of the watchdog.
//
// A stage calls beat() in every iteration of its loop, with or without work, and rests while it
// waits for another stage: the waiting stage is not stuck, the other one may be.
// Thread safety: beat() and rest() from the stage's thread, the other functions from any.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace rayloc {

class StageProgress {
 public:
  void beat() {
    resting_.store(false, std::memory_order_relaxed);
    beats_.fetch_add(1, std::memory_order_release);
  }
  void rest() { resting_.store(true, std::memory_order_release); }

  bool started() const { return beats() > 0; }
  bool resting() const { return resting_.load(std::memory_order_acquire); }
  std::uint64_t beats() const { return beats_.load(std::memory_order_acquire); }

 private:
  std::atomic<std::uint64_t> beats_{0};
  std::atomic<bool> resting_{false};
};

// A stage with its name in the log: "source ap1", "estimation". The progress outlives this.
struct Stage {
  std::string name;
  const StageProgress* progress = nullptr;
  bool has_shared_thread = false;  // on which stages of other sites run as well
};

}  // namespace rayloc
