#include "daemon/cli/terminal/terminal_screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string_view>

#include "daemon/cli/terminal/text_table.h"

namespace rayloc::cli {
namespace {

constexpr std::string_view kEnter = "\x1b[?1049h\x1b[?25l";  // alternate screen, no cursor
constexpr std::string_view kLeave = "\x1b[?25h\x1b[?1049l";
constexpr std::string_view kHome = "\x1b[H";
constexpr std::string_view kEndOfLine = "\x1b[K";
constexpr std::string_view kRest = "\x1b[J";

// Set by the handler alone; for the single screen.
volatile std::sig_atomic_t end_asked = 0;    // NOLINT: a signal handler can write to globals only
volatile std::sig_atomic_t pause_asked = 0;  // NOLINT
volatile std::sig_atomic_t stale = 0;        // NOLINT

void note(int signal) {
  if (signal == SIGTSTP) {
    pause_asked = 1;
  } else if (signal == SIGWINCH || signal == SIGCONT) {
    stale = 1;
  } else {
    end_asked = 1;
  }
}

bool write_all(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), text.size());
    if (written < 0 && errno != EINTR && errno != EAGAIN) {
      return false;
    }
    text.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
  }
  return true;
}

struct Size {
  std::size_t columns = 80;
  std::size_t rows = 24;
};

Size size_of_terminal() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
    return {};
  }
  return {size.ws_col, size.ws_row};
}

}  // namespace

bool TerminalScreen::is_possible() {
  const char* kind = std::getenv("TERM");
  return ::isatty(STDOUT_FILENO) == 1 && kind != nullptr && std::string_view(kind) != "dumb";
}

TerminalScreen::TerminalScreen() {
  end_asked = 0;
  pause_asked = 0;
  struct sigaction action {};
  action.sa_handler = note;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals.at(i), &action, &handlers_.at(i));
  }
  enter();
}

TerminalScreen::~TerminalScreen() {
  leave();
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals.at(i), &handlers_.at(i), nullptr);
  }
}

void TerminalScreen::enter() {
  has_keys_ = ::isatty(STDIN_FILENO) == 1 && ::tcgetattr(STDIN_FILENO, &before_) == 0;
  if (has_keys_) {
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    keys.c_cc[VMIN] = 0;
    keys.c_cc[VTIME] = 0;
    ::tcsetattr(STDIN_FILENO, TCSADRAIN, &keys);
  }
  write_all(kEnter);
}

void TerminalScreen::leave() {
  write_all(kLeave);
  if (has_keys_) {
    ::tcsetattr(STDIN_FILENO, TCSADRAIN, &before_);
  }
}

// As required by the shell's job control: restores the terminal, then stops by the same signal.
void TerminalScreen::pause_if_asked() {
  if (pause_asked == 0) {
    return;
  }
  pause_asked = 0;
  leave();
  struct sigaction by_default {};
  by_default.sa_handler = SIG_DFL;
  struct sigaction ours {};
  ::sigaction(SIGTSTP, &by_default, &ours);
  ::raise(SIGTSTP);  // returns after SIGCONT
  ::sigaction(SIGTSTP, &ours, nullptr);
  enter();
}

std::size_t TerminalScreen::columns() { return size_of_terminal().columns; }

bool TerminalScreen::draw(const std::vector<std::string>& lines) {
  pause_if_asked();
  stale = 0;  // before the size is read, to notice later changes
  const Size size = size_of_terminal();
  std::string frame(kHome);
  const std::size_t count = std::min(lines.size(), size.rows);
  for (std::size_t i = 0; i < count; ++i) {
    frame += cut(lines[i], size.columns);
    frame += kEndOfLine;
    frame += i + 1 < count ? "\r\n" : "";
  }
  frame += kRest;
  return write_all(frame);
}

std::optional<char> TerminalScreen::key() {
  char pressed = 0;
  if (!has_keys_ || ::read(STDIN_FILENO, &pressed, 1) != 1) {
    return std::nullopt;
  }
  return pressed;
}

bool TerminalScreen::ended() const { return end_asked != 0; }

bool TerminalScreen::is_stale() const { return stale != 0 || pause_asked != 0; }

}  // namespace rayloc::cli
