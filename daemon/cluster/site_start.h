// SiteStart: how the next owner of a site begins, read from the last word of the one before it.
#pragma once

#include <cstdint>
#include <memory>

#include "daemon/cluster/site_resume.h"
#include "daemon/pipeline/warm/carried.h"
#include "engine/base/expected.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

struct SiteStart {
  std::uint64_t generation = 0;       // of its claim
  SiteResume resume;                  // from where it reads
  Timestamp from = Timestamp::min();  // what is before it has been said
  // `open` is of where it begins to listen; null: nobody knows anything.
  std::shared_ptr<const Carried> carried;
};

// `record`: the last of the site; an empty one: nobody has said anything. An Error (kBadInput) says
// what of it contradicts itself.
Expected<SiteStart> start_after(const v1::OutputRecord& record);

// How the owner that began so has computed what it says: as start_after() unless it had stood by.
Expected<SiteStart> start_of(const v1::Begin& begin);

// Times of results: the microsecond that is not later; 0 before all time.
std::int64_t us_of(Timestamp time);
Timestamp time_of_us(std::int64_t us);

}  // namespace rayloc
