#include "daemon/cli/terminal/line_input.h"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace rayloc::cli {

void LineInput::poll() {
  pollfd waiting{descriptor_, POLLIN, 0};
  while (!ended_ && ::poll(&waiting, 1, 0) > 0) {
    std::array<char, 1024> bytes{};
    const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) {
      return;
    }
    if (count <= 0) {
      ended_ = true;
      if (!rest_.empty()) {
        lines_.push_back(std::exchange(rest_, {}));
      }
      return;
    }
    for (const char c : std::string(bytes.data(), static_cast<std::size_t>(count))) {
      if (c == '\n') {
        lines_.push_back(std::exchange(rest_, {}));
      } else if (c != '\r') {
        rest_ += c;
      }
    }
  }
}

}  // namespace rayloc::cli
