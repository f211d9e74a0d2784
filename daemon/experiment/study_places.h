// Places of a study: where spots, walks, the points of a survey and a fixed transmitter may be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "daemon/experiment/condition.h"
#include "daemon/scene/room_plan.h"
#include "daemon/simulate/random_stream.h"
#include "daemon/simulate/solid_objects.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc {

struct StudyPlaces {
  const RoomPlan& plan;
  const Scene& scene;  // as built
  const Condition& condition;
  std::optional<Vec3d> transmitter;     // of people
  const SolidObjects* moved = nullptr;  // objects where they are on a second day

  // [m], from the walls; in a narrow room a quarter of its width.
  double wall_margin() const;
  // Of boxes and, for people, of devices.
  bool is_clear(const Vec3d& place) const;
  bool is_between_walls(const Vec3d& place) const;
  // Clear, and of the distance and the sight that the condition asks of spots.
  bool suits(const Vec3d& spot) const;
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

// The place of a fixed transmitter of people: clear of boxes and not beside an access point. An
// Error where the room has none.
Expected<Vec3d> draw_transmitter(const StudyPlaces& places, std::uint64_t seed, std::size_t layout);

// As many as Condition::spots. An Error where the room has hardly a place that suits.
Expected<std::vector<Vec3d>> draw_spots(const StudyPlaces& places,
                                        std::uint64_t seed,
                                        std::size_t layout);

// Clear places anywhere in the room, as many as Condition::survey_points or as there are.
std::vector<Vec3d> draw_survey(const StudyPlaces& places, std::uint64_t seed, std::size_t layout);

}  // namespace rayloc
