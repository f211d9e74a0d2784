// `rayloc calibrate SITE --rechain`: new chain gains after a power cycle, the room kept.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc::cli {

struct RechainArguments {
  std::string site;                     // calibrated
  std::vector<std::string> captures;    // [AP=]FILE
  std::string points;                   // csv; empty: devices anywhere, and fixed transmitters
  std::optional<Duration> time_offset;  // added to the times of the points
  std::string out;                      // folder to create
  bool force = false;
  bool quiet = false;
  bool unsurveyed = false;  // the site is not calibrated: its plan and devices anywhere are all
};

// Writes `out` as a complete site with report.json. Access points without a recording keep their
// gains. Without points they are learned from devices (learn_chains()), else refitted from the
// fixed transmitters. An Error when the site is not calibrated, an access point's chains cannot be
// learned and it heard no transmitter at a known place, or what it heard contradicts the calibrated
// room (refit_chains()).
Expected<void> run_rechain(const RechainArguments& arguments);

}  // namespace rayloc::cli
