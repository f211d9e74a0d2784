#include "daemon/live/publish/board/presence.h"

#include <algorithm>
#include <cmath>

#include "daemon/messages/proto_time.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

constexpr double kLongestStep = 2.0;     // [s] between estimates of a target that remains present
constexpr std::size_t kMaxTracks = 512;  // maximum number summed at once
constexpr double kFarthest = 1e6;        // [m] from the origin

}  // namespace

std::int64_t Presence::number_at(Timestamp time) const {
  const Duration slot = kept_ / static_cast<std::int64_t>(kSlots);
  return time.time_since_epoch() / std::max(slot, Duration{1});
}

// All messages carry a time, so that old slots are also removed while no target is located.
void Presence::forget(Timestamp now) {
  const std::int64_t oldest = number_at(now) - static_cast<std::int64_t>(kSlots) + 1;
  for (Slot& slot : slots_) {
    if (slot.number < oldest) {
      slot.seconds.clear();
    }
  }
}

void Presence::add(const v1::Envelope& envelope) {
  const Timestamp time = from_proto(envelope.sent());
  forget(time);
  if (!envelope.has_location() || !envelope.location().has_position() ||
      envelope.location().kind() != v1::LOCATION_KIND_FILTERED) {
    return;
  }
  const v1::Location& location = envelope.location();
  const Track track{location.target().kind(), location.target().track()};
  const double x = location.position().x();
  const double y = location.position().y();
  std::erase_if(seen_, [&](const auto& one) {
    return std::abs(to_seconds(time - one.second)) > kLongestStep;
  });
  const auto before = seen_.find(track);
  const double step = before == seen_.end() ? 0.0 : to_seconds(time - before->second);
  if (before != seen_.end() || seen_.size() < kMaxTracks) {
    seen_[track] = time;
  } else {
    ++left_out_;
  }
  if (!(step > 0.0) || !(std::abs(x) < kFarthest) || !(std::abs(y) < kFarthest)) {
    return;
  }
  const std::int64_t number = number_at(time);
  Slot& slot = slots_.at(static_cast<std::size_t>(number) % kSlots);
  if (slot.number != number) {
    slot = {number, {}};
  }
  const Place place{static_cast<std::int32_t>(std::floor(x / kCell)),
                    static_cast<std::int32_t>(std::floor(y / kCell))};
  if (slot.seconds.size() < kMaxCells || slot.seconds.count(place) > 0) {
    slot.seconds[place] += step;
  } else {
    ++left_out_;
  }
}

std::vector<Presence::Cell> Presence::cells(Timestamp now) const {
  const std::int64_t last = number_at(now);
  std::map<Place, double> sums;
  for (const Slot& slot : slots_) {
    if (slot.number > last - static_cast<std::int64_t>(kSlots) && slot.number <= last) {
      for (const auto& [place, seconds] : slot.seconds) {
        sums[place] += seconds;
      }
    }
  }
  std::vector<Cell> cells;
  cells.reserve(sums.size());
  for (const auto& [place, seconds] : sums) {
    cells.push_back({(place.first + 0.5) * kCell, (place.second + 0.5) * kCell, seconds});
  }
  return cells;
}

}  // namespace rayloc
