#include "daemon/lab/experiment/study_room.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "daemon/lab/simulate/channel_list.h"
#include "daemon/lab/simulate/random_stream.h"
#include "daemon/site/scene/build_room.h"
#include "engine/em/radio_material.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

constexpr double kClear = 0.05;              // [m], between a box and its neighbours
constexpr double kClearOfAccessPoint = 0.3;  // [m]
constexpr double kMinTolerance = 2e-3;       // [m]: tolerance of the best calibration
constexpr const char* kWood = "clutter_wood";
constexpr const char* kMetal = "clutter_metal";

// Half the diagonal of its base.
double reach(const PlanBox& box) { return 0.5 * std::hypot(box.size.x, box.size.y); }

double distance_in_plan(const Vec3d& a, const Vec3d& b) { return std::hypot(a.x - b.x, a.y - b.y); }

bool is_clear(const RoomPlan& plan, const PlanBox& box) {
  const bool of_boxes = std::all_of(plan.boxes.begin(), plan.boxes.end(), [&](const PlanBox& b) {
    return distance_in_plan(b.centre, box.centre) > reach(b) + reach(box) + kClear;
  });
  return of_boxes &&
         std::all_of(
             plan.access_points.begin(), plan.access_points.end(), [&](const SiteAccessPoint& ap) {
               return distance_in_plan(ap.array.pose.position, box.centre) >
                      reach(box) + kClearOfAccessPoint;
             });
}

// Returns empty if the box would not fit into the room.
std::optional<PlanBox> draw_box(const RoomPlan& plan, RandomStream& random) {
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  PlanBox box;
  const double width = between(0.3, 0.8);
  const double depth = between(0.3, 0.8);
  const double height = between(0.5, 1.5);
  box.size = {width, depth, std::min(height, 0.8 * (plan.upper.z - plan.lower.z))};
  box.yaw = between(0.0, std::numbers::pi);
  box.material = between(0.0, 1.0) < 0.7 ? kWood : kMetal;
  const double margin = reach(box) + kClear;
  if (plan.upper.x - plan.lower.x < 2.0 * margin || plan.upper.y - plan.lower.y < 2.0 * margin) {
    return std::nullopt;
  }
  const double x = between(plan.lower.x + margin, plan.upper.x - margin);
  const double y = between(plan.lower.y + margin, plan.upper.y - margin);
  box.centre = {x, y, plan.lower.z + 0.5 * box.size.z};
  return box;
}

Expected<RadioMaterial> evaluate(const StatedMaterial& material, double carrier_hz) {
  if (!material.itu.empty()) {
    auto found = itu_material(material.itu, carrier_hz, material.thickness);
    if (found) {
      found->name = material.name;
    }
    return found;
  }
  return RadioMaterial{
      material.name, material.relative_permittivity, material.conductivity, material.thickness};
}

Expected<Scene> make_scene(const RoomPlan& plan) {
  const StatedScene stated = build_room(plan);
  Scene::Input input;
  input.carrier_hz = plan.carrier.grid.centre_hz;
  for (const StatedMaterial& material : stated.materials) {
    auto evaluated = evaluate(material, input.carrier_hz);
    RAYLOC_TRY(evaluated);
    input.materials.push_back(*std::move(evaluated));
  }
  for (const StatedObject& object : stated.objects) {
    const auto material = std::find_if(
        stated.materials.begin(), stated.materials.end(), [&](const StatedMaterial& m) {
          return m.name == object.material;
        });
    input.objects.push_back({object.name,
                             object.mesh,
                             static_cast<std::uint32_t>(material - stated.materials.begin())});
  }
  return Scene::create(std::move(input));
}

// Scales the antennas about their centre so that the two nearest ones have that spacing.
void set_spacing(double spacing, std::vector<Vec3d>& offsets) {
  double nearest = 0.0;
  Vec3d middle;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    middle = middle + (1.0 / static_cast<double>(offsets.size())) * offsets[i];
    for (std::size_t j = 0; j < i; ++j) {
      const double apart = norm(offsets[i] - offsets[j]);
      nearest = nearest > 0.0 ? std::min(nearest, apart) : apart;
    }
  }
  for (Vec3d& offset : offsets) {
    offset = nearest > 0.0 ? middle + (spacing / nearest) * (offset - middle) : offset;
  }
}

}  // namespace

Expected<RoomPlan> furnish(const RoomPlan& original,
                           const Condition& condition,
                           std::uint64_t seed,
                           std::size_t layout) {
  RoomPlan plan = original;
  const auto count = static_cast<std::size_t>(condition.access_points);
  if (plan.access_points.size() < count) {
    return make_error(ErrorKind::kConfiguration,
                      condition.room.string() + ": " + std::to_string(count) +
                          " access points are asked for, the plan states " +
                          std::to_string(plan.access_points.size()) + "; add [[access_point]]");
  }
  plan.access_points.resize(count);
  if (condition.ap_height_m > 0.0) {
    for (SiteAccessPoint& ap : plan.access_points) {
      ap.array.pose.position.z = condition.ap_height_m;
    }
  }
  if (condition.antenna_spacing_m > 0.0) {
    for (SiteAccessPoint& ap : plan.access_points) {
      set_spacing(condition.antenna_spacing_m, ap.array.element_offset);
    }
  }
  const auto boxes = static_cast<std::size_t>(condition.boxes);
  if (boxes > 0) {
    plan.materials.push_back({kWood, "wood", 1.0, 0.0, 0.02});
    plan.materials.push_back({kMetal, "metal", 1.0, 0.0, 0.001});
  }
  RandomStream random = random_stream(seed, "clutter", layout);
  constexpr int kAttempts = 100'000;
  std::size_t placed = 0;
  for (int attempt = 0; placed < boxes; ++attempt) {
    if (attempt == kAttempts) {
      return make_error(ErrorKind::kConfiguration,
                        condition.room.string() + ": no room for " + std::to_string(boxes) +
                            " boxes of clutter, only for " + std::to_string(placed) +
                            "; ask for fewer");
    }
    auto box = draw_box(plan, random);
    if (box && is_clear(plan, *box)) {
      box->name = "clutter" + std::to_string(placed++);
      plan.boxes.push_back(*std::move(box));
    }
  }
  return plan;
}

RoomPlan misplace(RoomPlan plan,
                  const Condition& condition,
                  std::uint64_t seed,
                  std::size_t layout) {
  RandomStream random = random_stream(seed, "plan error", layout);
  std::normal_distribution<double> normal;
  const auto off = [&] { return condition.plan_error_m * normal(random); };
  for (double* side : {&plan.lower.x, &plan.lower.y, &plan.upper.x, &plan.upper.y, &plan.upper.z}) {
    *side += off();
  }
  for (PlanBox& box : plan.boxes) {
    box.centre.x += off();
    box.centre.y += off();
  }
  // Openings end at the end of their wall.
  for (PlanOpening& opening : plan.openings) {
    const bool along_y = opening.wall == RoomSide::kWest || opening.wall == RoomSide::kEast;
    opening.lower[0] = std::max(opening.lower[0], along_y ? plan.lower.y : plan.lower.x);
    opening.upper[0] = std::min(opening.upper[0], along_y ? plan.upper.y : plan.upper.x);
    opening.upper[1] = std::min(opening.upper[1], plan.upper.z);
  }
  return plan;
}

Expected<std::vector<RoomPlan>> on_channels(const RoomPlan& plan, const Condition& condition) {
  if (condition.channels == "plan") {
    return std::vector<RoomPlan>{plan};
  }
  const auto channels =
      parse_channels(condition.channels, {plan.carrier.grid.centre_hz, plan.carrier.bandwidth_mhz});
  const std::string place = condition.room.string() + ": channels \"" + condition.channels + "\": ";
  if (!channels) {
    return make_error(ErrorKind::kConfiguration, place + channels.error().message);
  }
  if (condition.frames < static_cast<double>(channels->size())) {
    return make_error(ErrorKind::kConfiguration,
                      place + "each spot needs a frame on each of the " +
                          std::to_string(channels->size()) + " channels; 'frames' is " +
                          condition_text(condition, "frames"));
  }
  std::vector<RoomPlan> plans;
  for (const RadioChannel& channel : *channels) {
    plans.push_back(plan);
    plans.back().carrier.grid.centre_hz = channel.centre_hz;
  }
  return plans;
}

Expected<RoomModel> make_room(const RoomPlan& plan, const Condition& condition) {
  auto scene = make_scene(plan);
  if (!scene) {
    return make_error(scene.error().kind, condition.room.string() + ": " + scene.error().message);
  }
  RoomModel room;
  room.name = plan.name;
  room.scene = std::make_shared<const Scene>(*std::move(scene));
  room.bounds_min = plan.lower;
  room.bounds_max = plan.upper;
  room.grid = plan.carrier.grid;
  room.device.height = condition.device_height_m;
  room.device.height_sigma = condition.model_height_sigma_m;
  for (const SiteAccessPoint& ap : plan.access_points) {
    ModelError error;
    error.plan_tolerance = std::max(condition.plan_error_m, kMinTolerance);
    room.access_points.push_back({ap.id, ap.array, ap.rx_chains, {}, error});
  }
  return room;
}

bool is_in_box(const RoomPlan& plan, const Vec3d& place, double margin) {
  return std::any_of(plan.boxes.begin(), plan.boxes.end(), [&](const PlanBox& box) {
    const Vec3d from = place - box.centre;
    const double along = std::cos(box.yaw) * from.x + std::sin(box.yaw) * from.y;
    const double across = -std::sin(box.yaw) * from.x + std::cos(box.yaw) * from.y;
    return std::abs(along) < 0.5 * box.size.x + margin &&
           std::abs(across) < 0.5 * box.size.y + margin &&
           std::abs(from.z) < 0.5 * box.size.z + margin;
  });
}

}  // namespace rayloc
