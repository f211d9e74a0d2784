// LineInput: lines of standard input for a loop that also waits for other events.
#pragma once

#include <deque>
#include <optional>
#include <string>

namespace rayloc::cli {

class LineInput {
 public:
  explicit LineInput(int descriptor) : descriptor_(descriptor) {}

  // Reads the available input without waiting.
  void poll();
  // True after the end of the input; earlier lines may still be pending.
  bool ended() const { return ended_; }
  // The oldest line that was not taken yet, without its line end.
  const std::string* front() const { return lines_.empty() ? nullptr : &lines_.front(); }
  void pop() { lines_.pop_front(); }

 private:
  int descriptor_;
  bool ended_ = false;
  std::string rest_;  // part of a line that is incomplete
  std::deque<std::string> lines_;
};

}  // namespace rayloc::cli
