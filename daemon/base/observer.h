// Observer: receives the progress and the messages of a long computation, which prints nothing.
#pragma once

#include <functional>
#include <string>

namespace rayloc {

// Empty functions: nothing is reported. A computation calls them from one thread at a time.
struct Observer {
  // `share` of the current part of the work done so far, 0 to 1; `stage`: the current work, such as
  // "joint fit, step 12".
  std::function<void(double share, const std::string& stage)> on_progress;
  std::function<void(const std::string& note)> on_note;  // a message for the user, without newline

  void progress(double share, const std::string& stage) const {
    if (on_progress) {
      on_progress(share, stage);
    }
  }
  void note(const std::string& text) const {
    if (on_note) {
      on_note(text);
    }
  }
};

}  // namespace rayloc
