// TerminalScreen: a full screen of text on the terminal of standard output, by the escape sequences
// common to all terminals derived from ECMA-48 and xterm.
//
//   TerminalScreen screen;                 // alternate screen, no cursor, unbuffered keys
//   while (!screen.ended()) { screen.draw(lines); ... if (screen.key() == 'q') break; }
//                                          // the destructor restores the terminal
//
// SIGINT, SIGTERM, SIGHUP and SIGQUIT make ended() true; SIGTSTP restores the terminal until
// SIGCONT. Each of them, and SIGWINCH, interrupts a waiting call (EINTR), so that the requested
// action is taken at the next draw().
//
// At most one at a time. Thread safety: one thread.
#pragma once

#include <termios.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace rayloc::cli {

class TerminalScreen {
 public:
  // REQUIRES: is_possible().
  TerminalScreen();
  ~TerminalScreen();
  TerminalScreen(const TerminalScreen&) = delete;
  TerminalScreen& operator=(const TerminalScreen&) = delete;

  // True if standard output is a terminal with cursor control.
  static bool is_possible();

  // Present number of characters per line.
  static std::size_t columns();
  // Draws the lines that fit into the present size of the terminal. False if it is gone.
  bool draw(const std::vector<std::string>& lines);
  // A key pressed since the last call.
  std::optional<char> key();
  // True if a signal requested the end.
  bool ended() const;
  // True if the size has changed, or the process was resumed, since the last draw().
  bool is_stale() const;

 private:
  static constexpr std::array kSignals = {
      SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGCONT, SIGWINCH};

  void enter();
  void leave();
  void pause_if_asked();

  bool has_keys_ = false;  // standard input is a terminal with our settings
  termios before_{};
  std::array<struct sigaction, kSignals.size()> handlers_{};
};

}  // namespace rayloc::cli
