// Recomputes the published results of a site: runs each of its owners again, from the same
// place of the site's stream, with the same carried state, up to the end of its results.
// The streams alone determine the output, so the bytes are equal; this is checked.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "capture/transport/datagram_source.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/site_start.h"
#include "daemon/pipeline/pipeline.h"
#include "engine/base/expected.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

struct StreamReplay {
  std::string site;
  std::vector<std::string> access_points;  // ids
  // Runs a pipeline with that start until its sources, one for each access point, have ended.
  std::function<Expected<void>(const SiteStart& start,
                               std::vector<std::unique_ptr<DatagramSource>> sources,
                               LocationSink& sink)>
      run;
  // Computes as if the first owner had never been replaced: the located targets must then
  // be the same at the same instants, and positions differ a little after each take-over.
  bool uninterrupted = false;
  // Called with each result, in order.
  std::function<void(const v1::OutputItem& item)> on_result;
};

struct StreamReplayReport {
  std::size_t owners = 0;          // replayed
  std::size_t items = 0;           // their results
  std::size_t differing = 0;       // different from the published results, or missing
  std::vector<std::string> notes;  // obstacles to a replay, and differences
};

// An Error where no owner can be replayed.
Expected<StreamReplayReport> replay_stream(const std::shared_ptr<Broker>& broker,
                                           const StreamReplay& replay);

}  // namespace rayloc
