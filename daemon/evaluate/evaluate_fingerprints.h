// The control of `rayloc evaluate` by fingerprints: the errors of answering the surveyed point
// whose recording is most like that of the target.
#pragma once

#include <string>
#include <vector>

#include "daemon/evaluate/truth.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct FingerprintRequest {
  std::vector<std::string> survey;    // [AP=]FILE: recordings of the surveyed points
  std::string points;                 // csv of these
  std::vector<std::string> captures;  // [AP=]FILE: recordings of what is evaluated
  bool person = false;                // seen by fixed transmitters; else a device, which sends
  std::string transmitter;            // only this one; empty: whichever is heard most
};

// One error a point of `truth`, whose times are those of the recordings; infinite where nothing was
// heard. A spot is heard from begin to end, an instant for 0.1 s to either side.
Expected<std::vector<double>> fingerprint_errors(const Site& site,
                                                 const FingerprintRequest& request,
                                                 const std::vector<TruthPoint>& truth);

}  // namespace rayloc::cli
