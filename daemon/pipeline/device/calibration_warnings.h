// CalibrationWarnings: the warnings about the calibration that hold now, each fault once, and their
// text in the locations that they concern.
//
// Thread safety: any thread.
#pragma once

#include <mutex>
#include <span>
#include <vector>

#include "daemon/messages/location.h"
#include "engine/monitor/calibration_monitor.h"

namespace rayloc {

// True if `all` has a warning of the same problem and access point, for any of its chains.
bool is_stated(const CalibrationWarning& warning, const std::vector<CalibrationWarning>& all);

class CalibrationWarnings {
 public:
  // Replaces the warnings by those of the monitor, of the chains that are being learned where the
  // monitor does not state the same (with the size of the change), and of the dead chains.
  void set(std::vector<CalibrationWarning> monitor,
           std::vector<CalibrationWarning> learning,
           std::vector<CalibrationWarning> dead);
  void clear() { set({}, {}, {}); }

  std::vector<CalibrationWarning> now() const;

 private:
  mutable std::mutex mutex_;
  std::vector<CalibrationWarning> warnings_;  // guarded by mutex_
};

// Appends the texts to each location, except those of dead chains, which locations state already.
void append_texts(const std::vector<CalibrationWarning>& warnings, std::span<Location> locations);

}  // namespace rayloc
