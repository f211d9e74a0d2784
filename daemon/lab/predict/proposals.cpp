#include "daemon/lab/predict/proposals.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/predict/planned_room.h"
#include "daemon/site/scene/solid_around.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

constexpr double kMove = 0.5;             // [m], chosen: within the length of a cable
constexpr double kTurn = 45.0 * kDegree;  // [rad], chosen
constexpr double kCentimetre = 100.0;     // [cm/m]

struct Change {
  std::string what;
  RoomModel room;
};

// Rays of a row's centre do not depend on the distances of its antennas, so they are cached.
class MemoryGrids : public PathGridStore {
 public:
  std::optional<std::string> load(const std::string& key) override {
    const auto found = grids_.find(key);
    return found == grids_.end() ? std::nullopt : std::optional(found->second);
  }
  void save(const std::string& key, std::string_view bytes) override {
    grids_[key] = std::string(bytes);
  }
  void refuse(const std::string& key) override { grids_.erase(key); }

 private:
  std::map<std::string, std::string> grids_;
};

// `of`: converts the distances of a row to new ones.
template <typename Of>
Change with_gaps(const RoomModel& room, std::string what, const Of& of) {
  Change change{std::move(what), room};
  for (RoomAccessPoint& ap : change.room.access_points) {
    if (const std::vector<double> gaps = gaps_of(ap.array); !gaps.empty()) {
      set_gaps(ap.array, of(gaps));
    }
  }
  return change;
}

void add_spacings(const RoomModel& room, std::vector<Change>& changes) {
  const bool has_row = std::any_of(room.access_points.begin(),
                                   room.access_points.end(),
                                   [](const auto& ap) { return !gaps_of(ap.array).empty(); });
  if (!has_row) {
    return;  // they would all equal the unchanged room
  }
  const double half = 0.5 * kSpeedOfLight / room.grid.centre_hz;
  const auto all = [](double distance) {
    return [distance](std::vector<double> gaps) {
      std::fill(gaps.begin(), gaps.end(), distance);
      return gaps;
    };
  };
  changes.push_back(
      with_gaps(room, fmt::format("all antennas {:.1f} cm apart", kCentimetre * half), all(half)));
  const bool has_three = std::any_of(room.access_points.begin(),
                                     room.access_points.end(),
                                     [](const auto& ap) { return gaps_of(ap.array).size() > 1; });
  if (!has_three) {
    return;
  }
  changes.push_back(with_gaps(room,
                              fmt::format("the first two antennas {:.1f} cm apart, the others as "
                                          "they are",
                                          kCentimetre * half),
                              [&](std::vector<double> gaps) {
                                gaps.front() = half;
                                return gaps;
                              }));
  // In halves of a wavelength, coprime: one bearing alone has both phases.
  for (const auto& pair : {std::pair(1, 2), {1, 4}, {2, 3}, {3, 4}}) {
    const double first = pair.first * half;
    const double others = pair.second * half;
    changes.push_back(with_gaps(
        room,
        fmt::format(
            "antennas {:.1f} and {:.1f} cm apart", kCentimetre * first, kCentimetre * others),
        [&](std::vector<double> gaps) {
          std::fill(gaps.begin(), gaps.end(), others);
          gaps.front() = first;
          return gaps;
        }));
  }
}

bool is_possible(const RoomModel& room, const Vec3d& p) {
  return p.x > room.bounds_min.x && p.x < room.bounds_max.x && p.y > room.bounds_min.y &&
         p.y < room.bounds_max.y && !solid_around(*room.scene, p);
}

void add_moves(const RoomModel& room, std::vector<Change>& changes) {
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    const std::string& id = room.access_points[i].id;
    for (const Vec3d by : {Vec3d{kMove, 0, 0}, {-kMove, 0, 0}, {0, kMove, 0}, {0, -kMove, 0}}) {
      Change change{fmt::format("{} moved by x {:+.1f}, y {:+.1f} m", id, by.x, by.y), room};
      Vec3d& position = change.room.access_points[i].array.pose.position;
      position = position + by;
      if (is_possible(room, position)) {
        changes.push_back(std::move(change));
      }
    }
    for (const double by : {kTurn, -kTurn}) {
      Change change{fmt::format("{} rotated by {:+.0f} degrees", id, by / kDegree), room};
      change.room.access_points[i].array.pose.orientation.yaw += by;
      changes.push_back(std::move(change));
    }
  }
}

}  // namespace

Expected<std::vector<Proposal>> proposals(const RoomModel& room,
                                          const std::vector<Vec3d>& places,
                                          const PredictionOptions& options,
                                          const ProposalOptions& which) {
  std::vector<Change> changes{{"as it is", room}};
  if (which.spacings) {
    add_spacings(room, changes);
  }
  if (which.moves) {
    add_moves(room, changes);
  }
  PredictionOptions each = options;
  if (!each.path_grids) {
    each.path_grids = std::make_shared<MemoryGrids>();
  }
  std::vector<Proposal> found;
  for (Change& change : changes) {
    each.progress = [&](double share) {
      if (options.progress) {
        options.progress((static_cast<double>(found.size()) + share) /
                         static_cast<double>(changes.size()));
      }
    };
    auto prediction =
        predict(std::make_shared<const RoomModel>(std::move(change.room)), places, each);
    RAYLOC_TRY(prediction);
    found.push_back({std::move(change.what), *std::move(prediction)});
  }
  std::stable_sort(found.begin(), found.end(), [](const Proposal& a, const Proposal& b) {
    return std::pair(a.prediction.another_place, a.prediction.median_m) <
           std::pair(b.prediction.another_place, b.prediction.median_m);
  });
  return found;
}

}  // namespace rayloc
