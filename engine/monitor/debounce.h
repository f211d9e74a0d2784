// Debounce: a yes or no that changes only when it has been contradicted several times in a row.
#pragma once

namespace rayloc {

class Debounce {
 public:
  // Begins with no.
  explicit Debounce(int contradictions) : contradictions_(contradictions) {}

  void update(bool now) {
    run_ = now == state_ ? 0 : run_ + 1;
    if (run_ >= contradictions_) {
      state_ = now;
      run_ = 0;
    }
  }
  bool state() const { return state_; }

 private:
  int contradictions_;
  bool state_ = false;
  int run_ = 0;
};

}  // namespace rayloc
