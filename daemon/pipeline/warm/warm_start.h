// Start of a pipeline that continues from another one: it processes the last seconds again without
// output, and then reports what the other one would have reported.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "daemon/pipeline/warm/carried.h"
#include "engine/base/expected.h"

namespace rayloc {

struct WarmStart {
  // The first datagram to read. Older ones belong to bursts that have ended.
  Timestamp listen_from = Timestamp::min();
  OpenBursts open;                         // PipelineOptions
  Timestamp from = Timestamp::min();       // PipelineOptions
  std::shared_ptr<const Carried> carried;  // for the estimators; null: none
};

// `records`: of the predecessor, in order of time; empty: no state. `from`: time of its last
// output; empty: the end of the last record. At least `warm_up` is processed before that, and
// before the last frame of every target that was being followed. Where the records begin later than
// that, all datagrams are processed. An Error (kBadInput) if none ends before `from`.
Expected<WarmStart> warm_start(std::span<const Carried> records,
                               std::optional<Timestamp> from,
                               Duration warm_up);

}  // namespace rayloc
