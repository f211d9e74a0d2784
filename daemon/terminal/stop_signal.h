// StopSignal: lets a verb that runs until it is interrupted end cleanly on SIGINT and SIGTERM.
#pragma once

namespace rayloc::cli {

class StopSignal {
 public:
  // From now on the two signals end no process but interrupt waiting calls (EINTR).
  static void install();
  // The same for the first of them: another one ends the process at once, for what takes long to
  // end cleanly.
  static void install_once();
  static bool requested();
};

}  // namespace rayloc::cli
