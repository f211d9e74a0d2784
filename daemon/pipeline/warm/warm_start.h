// Where and how a pipeline begins that goes on in the place of another: it listens to the last
// seconds again, without a word, and then says what the other one would have said.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "daemon/pipeline/warm/carried.h"
#include "engine/base/expected.h"

namespace rayloc {

struct WarmStart {
  // The first datagram to read. Older ones are of bursts that are over.
  Timestamp listen_from = Timestamp::min();
  OpenBursts open;                         // PipelineOptions
  Timestamp from = Timestamp::min();       // PipelineOptions
  std::shared_ptr<const Carried> carried;  // of the estimators; null: nothing
};

// `records`: of the predecessor, in order of time; empty: nobody knows anything. `from`: when it
// was heard last; nothing: at the end of the last record. At least `warm_up` is listened to before
// that, and before the last frame of every target that was being followed. Where the records begin
// later than that, everything is listened to. An Error (kBadInput) where none ends before `from`.
Expected<WarmStart> warm_start(std::span<const Carried> records,
                               std::optional<Timestamp> from,
                               Duration warm_up);

}  // namespace rayloc
