// Debounce: a yes or no that changes only when it has been contradicted several times in a row.
#pragma once

namespace rayloc {

class Debounce {
 public:
  // Begins with no, or goes on with the state and the run of one before.
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
  int run() const { return run_; }  // of contradictions

 private:
  int contradictions_;
  bool state_;
  int run_;
};

}  // namespace rayloc
