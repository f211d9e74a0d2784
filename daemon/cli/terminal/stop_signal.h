// StopSignal: lets a verb that runs until interrupted end cleanly on SIGINT and SIGTERM.
#pragma once

namespace rayloc::cli {

class StopSignal {
 public:
  // After this call the two signals no longer end the process but interrupt waiting calls (EINTR).
  static void install();
  // The same for the first signal only: another one ends the
  // process at once, for verbs that take long to end cleanly.
  static void install_once();
  static bool requested();
  // Ends the process by SIGINT, as scripts expect, if a signal was received; otherwise returns.
  static void end_if_requested();
};

}  // namespace rayloc::cli
