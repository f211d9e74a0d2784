#include "daemon/pipeline/warm/warm_start.h"

#include <algorithm>
#include <utility>

namespace rayloc {
namespace {

// Chosen: time in which an assembler learns the composition of each transmitter's frames. Those
// frames are of bursts that have ended.
constexpr Duration kAssembly = std::chrono::seconds(1);

// The last instant before the frames that are processed again.
template <typename Record>
std::optional<Timestamp> moment_of(const MacAddress& transmitter, Record begin, Record end) {
  if (begin != end) {
    for (const Carried::People& people : begin->people) {
      if (people.transmitter == transmitter) {
        return people.moment;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

Expected<WarmStart> warm_start(std::span<const Carried> records,
                               std::optional<Timestamp> from,
                               Duration warm_up) {
  WarmStart start;
  if (records.empty()) {
    if (from) {
      start.from = *from;
      start.open.at = *from - warm_up;
      start.listen_from = start.open.at - kAssembly;
    }
    return start;
  }
  start.from = from.value_or(records.back().done);
  const auto last = std::find_if(records.rbegin(), records.rend(), [&](const Carried& record) {
    return record.done <= start.from;
  });
  if (last == records.rend()) {
    return bad_input("the first record is of a later time");
  }
  Carried carried = *last;
  const Timestamp needed = std::min(last->done, last->received) - warm_up;
  const auto begin = std::find_if(
      last, records.rend(), [&](const Carried& record) { return record.open.at <= needed; });
  if (begin != records.rend()) {
    start.open = begin->open;
    // Every open burst starts at `done` or later: earlier ones had ended.
    start.listen_from = begin->done - kAssembly;
  }
  for (Carried::People& people : carried.people) {
    people.moment = moment_of(people.transmitter, begin, records.rend());
  }
  start.carried = std::make_shared<const Carried>(std::move(carried));
  return start;
}

}  // namespace rayloc
