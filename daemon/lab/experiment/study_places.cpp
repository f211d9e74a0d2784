#include "daemon/lab/experiment/study_places.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "daemon/lab/experiment/study_room.h"
#include "daemon/lab/simulate/handling.h"

namespace rayloc {
namespace {

constexpr double kClearOfWalls = 0.3;         // [m]
constexpr double kClearOfBoxes = 0.05;        // [m]
constexpr double kDistanceTolerance = 0.25;   // [m]
constexpr double kClearOfDevices = 0.2;       // [m], for people
constexpr double kClearOfAccessPoints = 1.0;  // [m], for fixed transmitters

// Device heights have a random stream of their own: another deviation changes only the heights, at
// the same horizontal positions.
class Heights {
 public:
  Heights(const StudyPlaces& places, std::uint64_t seed, std::size_t layout)
      : sigma_(places.condition.height_sigma_m),
        lower_(places.plan.lower.z + kHeightMargin),
        upper_(places.plan.upper.z - kHeightMargin),
        random_(random_stream(seed, "heights", layout)) {}

  // Raises or lowers the place within the room.
  void change(Vec3d& place) {
    if (sigma_ <= 0.0) {
      return;
    }
    constexpr int kAttempts = 1000;
    double height = place.z + sigma_ * normal_(random_);
    for (int n = 0; n < kAttempts && (height < lower_ || height > upper_); ++n) {
      height = place.z + sigma_ * normal_(random_);
    }
    place.z = std::clamp(height, lower_, upper_);
  }

 private:
  double sigma_;
  double lower_;
  double upper_;
  RandomStream random_;
  std::normal_distribution<double> normal_;
};

}  // namespace

double StudyPlaces::wall_margin() const {
  const Vec3d size = plan.upper - plan.lower;
  return std::min({kClearOfWalls, 0.25 * size.x, 0.25 * size.y});
}

bool StudyPlaces::is_between_walls(const Vec3d& place) const {
  const double margin = wall_margin();
  return place.x >= plan.lower.x + margin && place.x <= plan.upper.x - margin &&
         place.y >= plan.lower.y + margin && place.y <= plan.upper.y - margin;
}

bool StudyPlaces::is_clear(const Vec3d& place) const {
  if (moved != nullptr && moved->contain(place)) {
    return false;
  }
  if (condition.kind != "person") {
    return !is_in_box(plan, place, kClearOfBoxes);
  }
  // A person is as high as furniture and does not overlap it.
  const double clear = condition.person_radius_m + kClearOfBoxes;
  const bool in_box = std::any_of(plan.boxes.begin(), plan.boxes.end(), [&](const PlanBox& box) {
    RoomPlan one;
    one.boxes = {box};
    return is_in_box(one, {place.x, place.y, box.centre.z}, clear);
  });
  const auto is_close = [&](const Vec3d& device) {
    return std::hypot(place.x - device.x, place.y - device.y) < clear + kClearOfDevices;
  };
  return !in_box && !(transmitter && is_close(*transmitter)) &&
         std::none_of(plan.access_points.begin(), plan.access_points.end(), [&](const auto& ap) {
           return is_close(ap.array.pose.position);
         });
}

bool StudyPlaces::suits(const Vec3d& test_point) const {
  const Vec3d& ap = plan.access_points.front().array.pose.position;
  const double distance = std::hypot(test_point.x - ap.x, test_point.y - ap.y);
  if (condition.distance_m > 0.0 &&
      std::abs(distance - condition.distance_m) > kDistanceTolerance) {
    return false;
  }
  const bool is_blocked = scene.is_blocked({ap, test_point});
  return is_clear(test_point) &&
         (condition.sight == "any" || is_blocked == (condition.sight == "nlos"));
}

AnyPlace::AnyPlace(const StudyPlaces& places)
    : along_x_(places.plan.lower.x + places.wall_margin(),
               places.plan.upper.x - places.wall_margin()),
      along_y_(places.plan.lower.y + places.wall_margin(),
               places.plan.upper.y - places.wall_margin()),
      height_(places.condition.device_height_m) {}

Vec3d AnyPlace::draw(RandomStream& random) {
  const double x = along_x_(random);
  const double y = along_y_(random);
  return {x, y, height_};
}

Expected<Vec3d> draw_transmitter(const StudyPlaces& places,
                                 std::uint64_t seed,
                                 std::size_t layout) {
  RandomStream random = random_stream(seed, "transmitter", layout);
  AnyPlace any(places);
  constexpr int kAttempts = 20'000;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Vec3d at = any.draw(random);
    const bool beside = std::any_of(
        places.plan.access_points.begin(), places.plan.access_points.end(), [&](const auto& ap) {
          const Vec3d& device = ap.array.pose.position;
          return std::hypot(at.x - device.x, at.y - device.y) < kClearOfAccessPoints;
        });
    if (!beside && !is_in_box(places.plan, at, kClearOfBoxes)) {
      return at;
    }
  }
  return make_error(ErrorKind::kConfiguration,
                    places.condition.room.string() +
                        ": no place for a fixed transmitter 1 m from every access point");
}

Expected<std::vector<Vec3d>> draw_test_points(const StudyPlaces& places,
                                              std::uint64_t seed,
                                              std::size_t layout) {
  const RoomPlan& plan = places.plan;
  const Condition& condition = places.condition;
  RandomStream random = random_stream(seed, "spots", layout);
  AnyPlace any(places);
  Heights heights(places, seed, layout);
  const auto count = static_cast<std::size_t>(condition.test_points);
  constexpr std::size_t kAttempts = 20'000;  // per test point
  std::vector<Vec3d> test_points;
  for (std::size_t attempt = 0; test_points.size() < count; ++attempt) {
    if (attempt == count * kAttempts) {
      return make_error(
          ErrorKind::kConfiguration,
          condition.room.string() + ": the room has hardly a place with sight \"" +
              condition.sight + "\" of access point '" + plan.access_points.front().id + "'" +
              (condition.distance_m > 0.0 ? " at " + condition_text(condition, "distance_m") + " m"
                                          : "") +
              ": " + std::to_string(test_points.size()) + " of " + std::to_string(count) +
              " were found; change 'sight', 'distance_m' or the plan");
    }
    Vec3d test_point = any.draw(random);
    heights.change(test_point);
    if (places.suits(test_point)) {
      test_points.push_back(test_point);
    }
  }
  return test_points;
}

std::vector<Vec3d> draw_survey(const StudyPlaces& places, std::uint64_t seed, std::size_t layout) {
  RandomStream random = random_stream(seed, "survey", layout);
  AnyPlace any(places);
  const auto count = static_cast<std::size_t>(places.condition.survey_points);
  constexpr std::size_t kAttempts = 1000;  // per point
  std::vector<Vec3d> points;
  for (std::size_t attempt = 0; points.size() < count && attempt < count * kAttempts; ++attempt) {
    const Vec3d at = any.draw(random);
    if (places.is_clear(at)) {
      points.push_back(at);
    }
  }
  return points;
}

}  // namespace rayloc
