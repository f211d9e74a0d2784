// Results of the owners of a site, in order, as far as the stream of results contains them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/site_start.h"
#include "engine/base/expected.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

// Results of one owner.
struct Chapter {
  SiteStart start;  // of its computation; a standby computed without publishing first
  v1::Begin begin;
  Timestamp from;                     // earlier results are from others
  Timestamp done;                     // all earlier results were published
  std::vector<v1::OutputItem> items;  // at instants from `from` up to `done`
};

// Owners whose Begin is stored. An Error where the broker does not answer, or has no results.
Expected<std::vector<Chapter>> read_story(Broker& broker, const std::string& site);

}  // namespace rayloc
