// SiteStart: start of the next owner of a site, derived from the last record of its predecessor.
#pragma once

#include <cstdint>
#include <memory>

#include "daemon/live/cluster/site_resume.h"
#include "daemon/pipeline/warm/carried.h"
#include "engine/base/expected.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

struct SiteStart {
  std::uint64_t generation = 0;       // of its claim
  SiteResume resume;                  // place to read from
  Timestamp from = Timestamp::min();  // earlier results have been published
  // `open` refers to the place from which it reads; null: no state.
  std::shared_ptr<const Carried> carried;
};

// `record`: the last one of the site; empty: none was
// published. An Error (kBadInput) states the inconsistency.
Expected<SiteStart> start_after(const v1::OutputRecord& record);

// Start from which that owner computed its results: as start_after() unless it was a standby.
Expected<SiteStart> start_of(const v1::Begin& begin);

// Times of results: rounded down to the microsecond; 0 before all time.
std::int64_t us_of(Timestamp time);
Timestamp time_of_us(std::int64_t us);

}  // namespace rayloc
