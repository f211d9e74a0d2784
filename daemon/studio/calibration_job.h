// CalibrationJob: `rayloc calibrate` of the site that is drawn, from the survey that was walked,
// for a button of the page. It works as a process of its own, so that what it costs or breaks is
// not its parent's, and ends with it.
//
// The calibrated site goes to a new folder in that of the site: "calibrated", "calibrated-2", ...
// Nothing that is there is changed.
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

#include "daemon/studio/child_process.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class CalibrationJob {
 public:
  // What was recorded since then, as `rayloc calibrate --capture` takes it: AP=FILE.
  using Recordings = std::function<Expected<std::vector<std::string>>(Timestamp since)>;

  CalibrationJob(std::filesystem::path site, Recordings recordings)
      : site_(std::move(site)), recordings_(std::move(recordings)) {}

  // "running"; while it does "share" (0 to 1), "text" and "seconds"; when it has ended "success",
  // "verdict" (one sentence), "folder", and "report" where there is one.
  nlohmann::ordered_json state();
  // `what`: "all" (surfaces, arrays, chains, materials) or "chains". An Error where one runs, or
  // where there is no survey or no recording of it.
  Expected<void> start(const std::string& what);
  // Nothing that it wrote counts.
  void stop();
  // report.html of the one that ended last.
  Expected<std::string> report() const;

 private:
  nlohmann::ordered_json progress() const;
  nlohmann::ordered_json outcome(int status) const;

  std::filesystem::path site_;
  Recordings recordings_;
  std::unique_ptr<ChildProcess> process_;
  std::filesystem::path out_;  // of that process
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace rayloc
