// LineInput: lines of standard input for a loop that has other things to wait for.
#pragma once

#include <deque>
#include <optional>
#include <string>

namespace rayloc::cli {

class LineInput {
 public:
  explicit LineInput(int descriptor) : descriptor_(descriptor) {}

  // Reads what is there without waiting.
  void poll();
  // Whether nothing will come any more; lines that came before may still be waiting.
  bool ended() const { return ended_; }
  // The oldest line that was not taken yet, without its end.
  const std::string* front() const { return lines_.empty() ? nullptr : &lines_.front(); }
  void pop() { lines_.pop_front(); }

 private:
  int descriptor_;
  bool ended_ = false;
  std::string rest_;  // of a line whose end has not come
  std::deque<std::string> lines_;
};

}  // namespace rayloc::cli
