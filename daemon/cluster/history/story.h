// What the owners of a site said, one after the other, as the stream of results still has it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/cluster/broker.h"
#include "daemon/cluster/site_start.h"
#include "engine/base/expected.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

// Of one owner.
struct Chapter {
  SiteStart start;  // as it began to compute; who had stood by computed in silence at first
  v1::Begin begin;
  Timestamp from;                     // what is before it was said by others
  Timestamp done;                     // everything before was said
  std::vector<v1::OutputItem> items;  // of instants from `from` up to `done`
};

// Those whose Begin is still there. An Error where the broker does not answer, or has no results.
Expected<std::vector<Chapter>> read_story(Broker& broker, const std::string& site);

}  // namespace rayloc
