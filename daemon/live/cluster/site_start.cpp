#include "daemon/live/cluster/site_start.h"

#include <chrono>
#include <string>
#include <utility>

#include "daemon/pipeline/output/carried_message.h"

namespace rayloc {

using std::chrono::microseconds;

std::int64_t us_of(Timestamp time) {
  return time == Timestamp::min()
             ? 0
             : std::chrono::floor<microseconds>(time.time_since_epoch()).count();
}

Timestamp time_of_us(std::int64_t us) {
  return us <= 0 ? Timestamp::min() : Timestamp(microseconds(us));
}

namespace {

// `state`: the carried state; null: none.
Expected<SiteStart> start_with(const v1::StreamPosition& resume,
                               std::int64_t from_us,
                               const v1::Carried* state) {
  SiteStart start;
  start.resume = resume_of(resume);
  start.from = time_of_us(from_us);
  if (state != nullptr) {
    auto carried = carried_of(*state);
    RAYLOC_TRY(carried);
    start.carried = std::make_shared<const Carried>(*std::move(carried));
  }
  return start;
}

Expected<SiteStart> start_with(const v1::StreamPosition& resume,
                               std::int64_t from_us,
                               const std::string& state) {
  v1::Carried carried;
  if (!carried.ParseFromString(state)) {
    return bad_input("the carried state in its Begin cannot be read");
  }
  return start_with(resume, from_us, state.empty() ? nullptr : &carried);
}

}  // namespace

Expected<SiteStart> start_after(const v1::OutputRecord& record) {
  if (record.has_output()) {
    const v1::SiteOutput& output = record.output();
    return start_with(
        output.resume(), output.done_us(), output.has_carried() ? &output.carried() : nullptr);
  }
  const v1::Begin& begin = record.begin();
  return start_with(begin.resume(), begin.done_us(), begin.carried());
}

Expected<SiteStart> start_of(const v1::Begin& begin) {
  if (begin.has_stood_by()) {
    const v1::StoodBy& stood_by = begin.stood_by();
    return start_with(stood_by.resume(), stood_by.from_us(), stood_by.carried());
  }
  return start_with(begin.resume(), begin.done_us(), begin.carried());
}

}  // namespace rayloc
