// The fingerprint control of `rayloc evaluate`: the errors of answering the surveyed point whose
// recording is most similar to that of the target.
#pragma once

#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/lab/evaluate/truth.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"

namespace rayloc {

struct FingerprintRequest {
  std::vector<std::string> survey;    // [AP=]FILE: recordings of the surveyed points
  std::string points;                 // csv of these
  std::vector<std::string> captures;  // [AP=]FILE: recordings of the target
  bool person = false;                // observed by fixed transmitters; else a device, which sends
  std::string transmitter;            // only this one; empty: the one received most often
};

// One error per point of `truth`, whose times are those of the recordings; infinite without frames.
// A test point uses the frames from its begin to its end, an instant those within 0.1 s to either
// side. Reports notes on the recordings (clock steps, gaps, rejected packets) to `observer`.
Expected<std::vector<double>> fingerprint_errors(const Site& site,
                                                 const FingerprintRequest& request,
                                                 const std::vector<TruthPoint>& truth,
                                                 const Observer& observer);

}  // namespace rayloc
