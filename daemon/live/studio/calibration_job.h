// CalibrationJob: runs `rayloc calibrate` for the drawn site with the walked survey, started by a
// button of the page. It is a separate process, so that its memory use and faults do not affect the
// parent, and it ends with the parent.
//
// The calibrated site goes to a new folder in that of the site: "calibrated", "calibrated-2", ...
// Existing files are not changed.
//
// Thread safety: one thread at a time.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/live/studio/child_process.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class CalibrationJob {
 public:
  // Recordings since that time, as arguments of `rayloc calibrate --capture`: AP=FILE.
  using Recordings = std::function<Expected<std::vector<std::string>>(Timestamp since)>;

  CalibrationJob(std::filesystem::path site, Recordings recordings)
      : site_(std::move(site)), recordings_(std::move(recordings)) {}

  // "running"; while it runs "share" (0 to 1), "text" and "seconds"; after it has ended "success",
  // "verdict" (one sentence), "folder", and "report" if there is one.
  nlohmann::ordered_json state();
  // `what`: "all" (surfaces, arrays, chains, materials) or "chains". Returns an Error if a job is
  // running, or if there is no survey or no recording of it.
  Expected<void> start(const std::string& what);
  // Ends the job and discards its output.
  void stop();
  // report.html of the last completed job.
  Expected<std::string> report() const;

 private:
  nlohmann::ordered_json progress() const;
  nlohmann::ordered_json outcome(int status) const;

  std::filesystem::path site_;
  Recordings recordings_;
  std::unique_ptr<ChildProcess> process_;
  std::filesystem::path out_;  // output folder of that process
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace rayloc
