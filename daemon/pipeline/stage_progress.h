// StageProgress: whether the thread of a stage gets on with its work; what the watchdog looks at.
//
// A stage beats each time that its loop comes round, work or none, and rests while it waits for
// another stage: who waits is not stuck, the one it waits for may be.
// Thread safety: beat() and rest() from the stage's thread, the rest from any.
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

// A stage as the log calls it: "source ap1", "estimation". The progress outlives this.
struct Stage {
  std::string name;
  const StageProgress* progress = nullptr;
};

}  // namespace rayloc
