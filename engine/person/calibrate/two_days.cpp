#include "engine/person/calibrate/two_days.h"

#include <algorithm>
#include <complex>
#include <optional>
#include <utility>

#include "engine/base/check.h"
#include "engine/observe/alignment.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

const EmptyRoom* find_array(std::span<const EmptyRoom> received, std::size_t access_point) {
  const auto found = std::find_if(received.begin(), received.end(), [&](const EmptyRoom& one) {
    return one.access_point == access_point;
  });
  return found == received.end() ? nullptr : &*found;
}

// The arrays of both days that were received on the other day, too.
ReceivedDays on_both(const ReceivedDays& received) {
  ReceivedDays both{received.surveyed, {}, {}};
  for (const EmptyRoom& one : received.today) {
    if (const EmptyRoom* before = find_array(received.people, one.access_point)) {
      both.people.push_back(*before);
      both.today.push_back(one);
    }
  }
  return both;
}

Expected<RotatedChains> compare(const RoomModel& room, const EmptyRoom& people, EmptyRoom today) {
  EmptyRoom before = people;
  const RoomAccessPoint& ap = room.access_points[people.access_point];
  apply_coupling(ap.gains, before.h);
  apply_coupling(ap.gains, today.h);
  auto chains = compare_days(room.grid, before.h, today.h);
  if (!chains) {
    return bad_input("access point " + ap.id + ": " + chains.error().message);
  }
  return chains;
}

// Replaces the gains removed from arrays: puts back `before` and removes `after`.
void remove_others(const ChainGains& before, const ChainGains& after, std::vector<Value>& h) {
  apply_coupling(before, h);
  for (std::size_t j = 0; j < h.size(); ++j) {
    h[j] *= before.gain[j];
  }
  remove_gains(after, h);
}

// How well the traced room explains a link.
double fit_of(const PersonReference& reference, std::size_t access_point) {
  for (const PersonLink& link : reference.links) {
    if (link.access_point == access_point) {
      return link.room_fit;
    }
  }
  return 0.0;
}

// Change of each access point between the days, from the transmitter with the least change.
Expected<std::vector<DayChange>> changes_of(const RoomModel& room,
                                            std::span<const ReceivedDays> received) {
  std::vector<DayChange> changes;
  for (const ReceivedDays& days : received) {
    if (days.today.empty()) {
      continue;
    }
    const auto people = fit_empty_room(room, days.surveyed, days.people);
    const auto today = fit_empty_room(room, days.surveyed, days.today);
    if (!people || !today) {
      return tl::make_unexpected(people ? today.error() : people.error());
    }
    for (std::size_t i = 0; i < days.today.size(); ++i) {
      auto chains = compare(room, days.people[i], days.today[i]);
      RAYLOC_TRY(chains);
      const std::size_t ap = days.today[i].access_point;
      DayChange change{ap, *std::move(chains), false, fit_of(*today, ap) < fit_of(*people, ap)};
      change.is_rotated = change.chains.is_rotated();
      const auto known = std::find_if(changes.begin(), changes.end(), [&](const DayChange& one) {
        return one.access_point == ap;
      });
      if (known == changes.end()) {
        changes.push_back(std::move(change));
      } else if (change.chains.changed < known->chains.changed) {
        *known = std::move(change);
      }
    }
  }
  return changes;
}

}  // namespace

Expected<TwoDays> separate_days(const RoomModel& room, std::span<const ReceivedDays> received) {
  TwoDays days{room, room, {}, {}};
  for (const ReceivedDays& one : received) {
    days.received.push_back(on_both(one));
  }
  auto changes = changes_of(room, days.received);
  RAYLOC_TRY(changes);
  days.changes = *std::move(changes);
  if (days.changes.empty()) {
    return bad_input(
        "no access point received a fixed transmitter in the empty rooms of both days");
  }
  for (const DayChange& change : days.changes) {
    if (!change.is_rotated) {
      continue;
    }
    const ChainGains& gains = room.access_points[change.access_point].gains;
    RoomModel& other = change.is_today_rotated ? days.today : days.people;
    ChainGains& own = other.access_points[change.access_point].gains;
    own = change.is_today_rotated ? rotated(gains, change.chains) : derotated(gains, change.chains);
    for (ReceivedDays& one : days.received) {
      for (EmptyRoom& array : change.is_today_rotated ? one.today : one.people) {
        if (array.access_point == change.access_point) {
          remove_others(gains, own, array.h);
        }
      }
    }
  }
  return days;
}

PersonReference moved_to_today(const OfdmGrid& grid,
                               PersonReference reference,
                               std::span<const EmptyRoom> today) {
  const Aligner aligner(grid);
  for (PersonLink& link : reference.links) {
    const EmptyRoom* received = find_array(today, link.access_point);
    RAYLOC_CHECK(received != nullptr);
    std::vector<Value> empty = received->h;
    aligner.apply(aligner.align(link.empty, empty), empty);
    link.empty = std::move(empty);
  }
  return reference;
}

}  // namespace rayloc
