// `rayloc calibrate SITE --rechain`: new chain gains after a power cycle, with the room unchanged.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc::cli {

struct RechainArguments {
  std::string site;                     // calibrated site
  std::vector<std::string> captures;    // [AP=]FILE
  std::string points;                   // csv; empty: devices anywhere and fixed transmitters
  std::optional<Duration> time_offset;  // offset added to the times of the points
  std::string out;                      // output folder, created
  bool force = false;
  bool quiet = false;
  bool unsurveyed = false;  // uncalibrated site: only its plan and devices anywhere are used
};

// Writes `out` as a complete site with report.json. Access points without a recording keep their
// gains. Without points the gains are learned from devices (learn_chains()), else refitted from the
// fixed transmitters. Returns an Error if the site is not calibrated, if an access point's chains
// cannot be learned and it received no transmitter at a known position, or if its observations
// contradict the calibrated room (refit_chains()).
Expected<void> run_rechain(const RechainArguments& arguments);

}  // namespace rayloc::cli
