// TerminalScreen: a full screen of text on the terminal of standard output, by the escape sequences
// that every terminal of ECMA-48 and xterm's descent understands.
//
//   TerminalScreen screen;                 // other screen, cursor hidden, keys come one by one
//   while (!screen.ended()) { screen.draw(lines); ... if (screen.key() == 'q') break; }
//                                          // the destructor gives back what there was
//
// SIGINT, SIGTERM, SIGHUP and SIGQUIT make ended() true; SIGTSTP gives the terminal back until
// SIGCONT. Each of them, and SIGWINCH, interrupts a waiting call (EINTR), so that what they ask for
// happens at the next draw().
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

  // Standard output is a terminal that understands more than lines.
  static bool is_possible();

  // Characters in a line, now.
  static std::size_t columns();
  // What fits of the lines, in the size that the terminal has now. False when it is gone.
  bool draw(const std::vector<std::string>& lines);
  // A key that was pressed since the last call.
  std::optional<char> key();
  // A signal asked for the end.
  bool ended() const;
  // The size has changed, or we come back from the background, since the last draw().
  bool is_stale() const;

 private:
  static constexpr std::array kSignals = {
      SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGCONT, SIGWINCH};

  void enter();
  void leave();
  void pause_if_asked();

  bool has_keys_ = false;  // standard input is a terminal, and its settings are ours
  termios before_{};
  std::array<struct sigaction, kSignals.size()> handlers_{};
};

}  // namespace rayloc::cli
