// What a cluster published of a site, again: each of its owners once more, from the same place of
// the site's stream, told the same, up to the instant up to which it spoke. The streams alone
// decide, so the bytes are the same; whether they are is looked at.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "capture/transport/datagram_source.h"
#include "daemon/cluster/broker.h"
#include "daemon/cluster/site_start.h"
#include "daemon/pipeline/pipeline.h"
#include "engine/base/expected.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

struct StreamReplay {
  std::string site;
  std::vector<std::string> access_points;  // ids
  // Runs a pipeline that begins so until its sources, one for each access point, have ended.
  std::function<Expected<void>(const SiteStart& start,
                               std::vector<std::unique_ptr<DatagramSource>> sources,
                               LocationSink& sink)>
      run;
  // As if the first owner had never been replaced: what is located must then be the same at the
  // same instants, and positions differ a little after each take-over.
  bool uninterrupted = false;
  // Is told each result, in order.
  std::function<void(const v1::OutputItem& item)> say;
};

struct StreamReplayReport {
  std::size_t owners = 0;          // that were gone through again
  std::size_t items = 0;           // results of theirs
  std::size_t differing = 0;       // among them and those that were published: others, or missing
  std::vector<std::string> notes;  // of what cannot be gone through again, and of differences
};

// An Error where nothing can be gone through again.
Expected<StreamReplayReport> replay_stream(const std::shared_ptr<Broker>& broker,
                                           const StreamReplay& replay);

}  // namespace rayloc
