// Renewal of chain gains as a use case: after a power cycle, with the room unchanged.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/lab/calibrate/report/refused_input.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

struct RechainArguments {
  std::string site;                     // calibrated site
  std::vector<std::string> captures;    // [AP=]FILE
  std::string points;                   // csv; empty: devices anywhere and fixed transmitters
  std::optional<Duration> time_offset;  // offset added to the times of the points
  std::string out;                      // output folder, created
  bool force = false;
  bool unsurveyed = false;  // uncalibrated site: only its plan and devices anywhere are used
};

struct ChainValues {
  double gain_db = 0.0;
  double phase_deg = 0.0;
};

// Mean gain and phase of a chain against another.
struct ChainChange {
  int rx_chain = 0;
  int against = 0;
  ChainValues before;
  ChainValues after;
  ChainValues sigma;  // of `after`
};

struct RechainedAccessPoint {
  std::string id;
  std::size_t learned_from = 0;     // bursts of devices; 0: refitted from known positions
  std::size_t points = 0;           // known positions
  bool ripple = false;              // refitted per tone
  std::optional<double> fit;        // of known positions: median squared correlation
  std::optional<double> usual_fit;  // the same when the room was calibrated
  std::vector<ChainChange> chains;
};

struct RechainResult {
  std::vector<RechainedAccessPoint> access_points;  // those with new gains
  std::vector<RefusedInput> refused;
};

// Writes `out` as a complete site with report.json. Access points without a recording keep their
// gains. Without points the gains are learned from devices (learn_chains()), else refitted from the
// fixed transmitters. Returns an Error if the site is not calibrated, if an access point's chains
// cannot be learned and it received no transmitter at a known position, or if its observations
// contradict the calibrated room (refit_chains()). `observer` receives the notes on the scene and
// the recordings. Threads may run it at the same time, each into a folder of its own.
Expected<RechainResult> run_rechain(const RechainArguments& arguments,
                                    const Observer& observer = {});

}  // namespace rayloc
