// Places of a study: allowed positions of test points, walks, survey points and a fixed
// transmitter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "daemon/lab/experiment/condition.h"
#include "daemon/lab/simulate/random_stream.h"
#include "daemon/lab/simulate/solid_objects.h"
#include "daemon/site/scene/room_plan.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc {

struct StudyPlaces {
  const RoomPlan& plan;
  const Scene& scene;  // scene as built
  const Condition& condition;
  std::optional<Vec3d> transmitter;     // for people
  const SolidObjects* moved = nullptr;  // positions of objects on a second day

  // Distance from the walls [m]; in a narrow room a quarter of its width.
  double wall_margin() const;
  // Clear of boxes and, for people, of devices.
  bool is_clear(const Vec3d& place) const;
  bool is_between_walls(const Vec3d& place) const;
  // Clear, with the distance and the line of sight that the condition requires of test points.
  bool suits(const Vec3d& test_point) const;
};

// Uniform over the room, at the height of devices.
class AnyPlace {
 public:
  explicit AnyPlace(const StudyPlaces& places);
  Vec3d draw(RandomStream& random);

 private:
  std::uniform_real_distribution<double> along_x_;
  std::uniform_real_distribution<double> along_y_;
  double height_;
};

// The position of a fixed transmitter for people: clear of boxes and away from access points.
// Returns an Error if the room has none.
Expected<Vec3d> draw_transmitter(const StudyPlaces& places, std::uint64_t seed, std::size_t layout);

// Draws Condition::test_points places. Returns an Error if the room has hardly any suitable place.
Expected<std::vector<Vec3d>> draw_test_points(const StudyPlaces& places,
                                              std::uint64_t seed,
                                              std::size_t layout);

// Clear places anywhere in the room: Condition::survey_points, or fewer if fewer are found.
std::vector<Vec3d> draw_survey(const StudyPlaces& places, std::uint64_t seed, std::size_t layout);

}  // namespace rayloc
