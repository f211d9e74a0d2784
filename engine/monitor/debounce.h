// Debounce: a binary state that changes only after several contradictions in a row.
#pragma once

namespace rayloc {

class Debounce {
 public:
  // Starts with false, or continues with the state and the run of an earlier object.
  explicit Debounce(int contradictions, bool state = false, int run = 0)
      : contradictions_(contradictions), state_(state), run_(run) {}

  void update(bool now) {
    run_ = now == state_ ? 0 : run_ + 1;
    if (run_ >= contradictions_) {
      state_ = now;
      run_ = 0;
    }
  }
  bool state() const { return state_; }
  int run() const { return run_; }  // contradictions in a row

 private:
  int contradictions_;
  bool state_;
  int run_;
};

}  // namespace rayloc
