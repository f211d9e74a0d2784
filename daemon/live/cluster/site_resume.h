// SiteResume: the place from which a site's stream is read again, and the
// batches taken before it; sent as v1::StreamPosition with every result.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "daemon/live/cluster/sequencer.h"
#include "daemon/live/cluster/stream_reader.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

struct SiteResume {
  StreamReader::Place place;
  Sequencer::Positions nodes;
  std::set<std::string> silent;  // nodes that are not waited for
  std::uint32_t shed_level = 0;  // as in v1::Shed
};

v1::StreamPosition position_message(const SiteResume& resume);
SiteResume resume_of(const v1::StreamPosition& message);

}  // namespace rayloc
