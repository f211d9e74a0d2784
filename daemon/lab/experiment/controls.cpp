#include "daemon/lab/experiment/controls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "daemon/lab/evaluate/fingerprint_map.h"
#include "engine/base/constants.h"
#include "engine/baselines/paths/bearing.h"
#include "engine/baselines/spotfi/spotfi.h"

namespace rayloc {
namespace {

constexpr std::array kControlNames = std::to_array<ControlName>({
    {"centre", "the middle of the room"},
    {"start", "the starting point of the walk"},
    {"nearest", "the surveyed point with the most similar CSI"},
    {"level", "received power alone, with SpotFi's path-loss model"},
    {"oracle", "SpotFi's bearing at the true range and the nearest alias"},
});

// An estimate at a place without any uncertainty.
LocationEstimate at(const Vec3d& place) {
  LocationEstimate estimate;
  estimate.position = place;
  estimate.is_uncertainty_stated = false;
  return estimate;
}

LocationEstimate no_position(std::string reason) {
  LocationEstimate estimate;
  estimate.reason = std::move(reason);
  return estimate;
}

tl::unexpected<Error> refuse(const std::string& why) {
  return make_error(ErrorKind::kConfiguration, why);
}

Expected<Locate> nearest(const RoomModel& room, const StudyLayout& layout) {
  if (layout.survey.empty()) {
    return refuse("no survey: survey_points is 0");
  }
  std::vector<FingerprintMap::AccessPoint> access_points;
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    access_points.push_back({i, room.access_points[i].rx_chains});
  }
  const auto map = std::make_shared<FingerprintMap>(room.grid, std::move(access_points));
  for (const StudyPoint& point : layout.survey) {
    map->add(point.position, point.frames);
  }
  return [map](const StudyPoint& test_point, std::size_t) {
    const auto place = map->nearest(test_point.frames);
    return place ? at(*place) : no_position("no frame was received");
  };
}

TrainingInput survey_of(std::shared_ptr<const RoomModel> room,
                        const StudyLayout& layout,
                        bool constant_power,
                        std::uint64_t seed) {
  TrainingInput input;
  input.room = std::move(room);
  input.seed = seed;
  for (const StudyPoint& point : layout.survey) {
    input.points.push_back({point.position, point.frames});
  }
  if (constant_power) {
    input.constant_power.push_back(kStudyTransmitter);
  }
  return input;
}

// SpotFi with all bearings treated as outliers.
Expected<Locate> power_only(std::shared_ptr<const RoomModel> room,
                            const StudyLayout& layout,
                            bool constant_power,
                            std::uint64_t seed) {
  if (layout.transmitter) {
    return refuse("received powers alone do not locate people");
  }
  if (layout.survey.empty()) {
    return refuse("no survey: survey_points is 0");
  }
  const auto learned = train_spotfi(survey_of(room, layout, constant_power, seed));
  RAYLOC_TRY(learned);
  auto training = std::make_shared<Training>(**learned);
  for (AccessPointTraining& ap : training->access_points) {
    ap.outliers = 1.0;
  }
  auto made = Spotfi::create(std::move(room), {}, std::move(training));
  RAYLOC_TRY(made);
  const auto spotfi = std::make_shared<const Spotfi>(*std::move(made));
  return [spotfi](const StudyPoint& test_point, std::size_t repeat) {
    return spotfi->locate(test_point.frames, repeat);
  };
}

// The first access point's bearing, with range and ambiguity from the truth: its best case.
Expected<Locate> oracle(std::shared_ptr<const RoomModel> room,
                        const StudyLayout& layout,
                        std::uint64_t seed) {
  if (layout.transmitter) {
    return refuse("people have no direct path to take a bearing of");
  }
  const auto comb = std::make_shared<const ToneComb>(tone_comb(room->grid));
  if (comb->tone.empty()) {
    return refuse("the carrier has no tones in equal steps");
  }
  return [room, comb, seed](const StudyPoint& test_point, std::size_t repeat) {
    LocationEstimate estimate;
    const auto path = find_direct_path(
        *room, 0, test_point.frames, {*comb, {}, seed + repeat}, estimate.warnings);
    if (!path) {
      return no_position("no bearing");
    }
    const AntennaArray& array = room->access_points[0].array;
    const Vec3d& from = array.pose.position;
    const double range = std::hypot(test_point.position.x - from.x, test_point.position.y - from.y);
    const double yaw = array.pose.orientation.yaw;
    double best = std::hypot(range, range);
    Vec3d place = from;
    for (const double sine :
         sines_of(path->psi, path->line.spacing, kSpeedOfLight / room->grid.centre_hz)) {
      const double angle = yaw + std::asin(std::clamp(sine, -1.0, 1.0));
      const Vec3d here{from.x + range * std::cos(angle),
                       from.y + range * std::sin(angle),
                       test_point.position.z};
      const double off = std::hypot(here.x - test_point.position.x, here.y - test_point.position.y);
      if (off < best) {
        best = off;
        place = here;
      }
    }
    return at(place);
  };
}

}  // namespace

std::span<const ControlName> control_names() { return kControlNames; }

Expected<Locate> make_control(std::string_view name,
                              std::shared_ptr<const RoomModel> room,
                              const StudyLayout& layout,
                              bool constant_power,
                              std::uint64_t seed) {
  if (name == "nearest") {
    return nearest(*room, layout);
  }
  if (name == "level") {
    return power_only(std::move(room), layout, constant_power, seed);
  }
  if (name == "oracle") {
    return oracle(std::move(room), layout, seed);
  }
  if (name == "start") {
    if (layout.walks.empty()) {
      return refuse("no person walks: motion is still");
    }
    return [](const StudyPoint& test_point, std::size_t) { return at(test_point.position); };
  }
  const Vec3d centre = 0.5 * (room->bounds_min + room->bounds_max);
  return [centre](const StudyPoint&, std::size_t) { return at(centre); };
}

}  // namespace rayloc
