#include "engine/calibrate/joint/room_unknowns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "engine/base/check.h"
#include "engine/scene/moved_surfaces.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

using Kind = Unknown::Kind;

constexpr double kParallel = 0.999;  // cosine between normals
constexpr double kTouching = 1e-4;   // [m]

// Walls, floor and ceiling bound the room; furniture is inside it.
bool is_furniture(const RoomModel& room, std::uint32_t s) {
  const std::uint32_t object = room.scene->owner(s).object;
  Vec3d lower = room.scene->objects()[object].mesh.vertices.front();
  Vec3d upper = lower;
  for (const Vec3d& v : room.scene->objects()[object].mesh.vertices) {
    lower = {std::min(lower.x, v.x), std::min(lower.y, v.y), std::min(lower.z, v.z)};
    upper = {std::max(upper.x, v.x), std::max(upper.y, v.y), std::max(upper.z, v.z)};
  }
  const Vec3d centre = 0.5 * (lower + upper);
  const auto inside = [](double value, double least, double most) {
    return value > least + kTouching && value < most - kTouching;
  };
  return inside(centre.x, room.bounds_min.x, room.bounds_max.x) &&
         inside(centre.y, room.bounds_min.y, room.bounds_max.y) &&
         inside(centre.z, room.bounds_min.z, room.bounds_max.z);
}

std::string direction_name(const Vec3d& n) {
  const std::array<std::pair<double, char>, 3> axes{{{n.x, 'x'}, {n.y, 'y'}, {n.z, 'z'}}};
  for (const auto& [component, axis] : axes) {
    if (std::abs(component) > kParallel) {
      return {component > 0.0 ? '+' : '-', axis};
    }
  }
  const auto degrees = std::lround(std::atan2(n.y, n.x) * 57.29577951308232);
  return "face" + std::to_string(degrees) + "deg";
}

// Faces of one object with the same normal direction are distinguished by a number.
std::string surface_name(const Scene& scene, std::uint32_t s) {
  const std::uint32_t object = scene.owner(s).object;
  const std::string direction = direction_name(scene.surfaces()[s].plane().normal);
  const auto [first, end] = scene.surfaces_of(object);
  int same = 0;
  int before = 0;
  for (std::uint32_t other = first; other < end; ++other) {
    if (direction_name(scene.surfaces()[other].plane().normal) == direction) {
      before += other < s ? 1 : 0;
      ++same;
    }
  }
  return scene.objects()[object].name + "." + direction +
         (same > 1 ? std::to_string(before + 1) : "");
}

// "ap1.core2/core0.coupling.re": coupling into the antenna of core 2 from that of core 0.
ParameterId coupling_id(const Unknown& unknown, const RoomAccessPoint& ap) {
  const std::size_t others = ap.rx_chains.size() - 1;
  const std::size_t to = unknown.part / 2 / others;
  const std::size_t from = unknown.part / 2 % others;
  return {ap.id + ".core" + std::to_string(ap.rx_chains[to]) + "/core" +
              std::to_string(ap.rx_chains[from < to ? from : from + 1]),
          unknown.part % 2 == 0 ? Quantity::kCouplingReal : Quantity::kCouplingImaginary};
}

// Combines a coupling (RoomUnknowns::coupling()) of the antennas with that of the gains.
void set_coupling(const double* values, ChainGains& gains) {
  const std::size_t rx_chains = gains.rx_chains.size();
  if (gains.empty() || std::all_of(values,
                                   values + 2 * rx_chains * (rx_chains - 1),
                                   [](double value) { return value == 0.0; })) {
    return;
  }
  std::vector<std::complex<double>> coupling;
  for (std::size_t a = 0; a < rx_chains; ++a) {
    for (std::size_t b = 0; b < rx_chains; ++b) {
      coupling.emplace_back(a == b ? 1.0 : values[0], a == b ? 0.0 : values[1]);
      values += a == b ? 0 : 2;
    }
  }
  apply_coupling(gains, coupling);
  gains.coupling = std::move(coupling);
}

}  // namespace

RoomUnknowns::RoomUnknowns(const RoomModel& room, const CalibrationPriors& priors)
    : surfaces_(static_cast<std::uint32_t>(room.scene->surfaces().size())) {
  add_surfaces(room, priors);
  materials_at_ = static_cast<std::uint32_t>(unknowns_.size());
  for (std::uint32_t m = 0; m < room.scene->materials().size(); ++m) {
    unknowns_.push_back({Kind::kPermittivity, m, 0, priors.permittivity});
    unknowns_.push_back({Kind::kConductivity, m, 0, priors.conductivity});
    unknowns_.push_back({Kind::kThickness, m, 0, priors.thickness});
  }
  add_arrays(room, priors);
}

void RoomUnknowns::add_surfaces(const RoomModel& room, const CalibrationPriors& priors) {
  for (std::uint32_t s = 0; s < surfaces_; ++s) {
    const double sigma = is_furniture(room, s) ? priors.furniture_surface : priors.room_surface;
    unknowns_.push_back({Kind::kSurfaceOffset, s, 0, sigma});
  }
  for (std::uint32_t s = 0; s < surfaces_; ++s) {
    unknowns_.push_back({Kind::kSurfaceGain, s, 0, priors.surface_gain});
    unknowns_.push_back({Kind::kSurfacePhase, s, 0, priors.surface_phase});
  }
}

void RoomUnknowns::add_arrays(const RoomModel& room, const CalibrationPriors& priors) {
  for (std::uint32_t i = 0; i < room.access_points.size(); ++i) {
    arrays_at_.push_back(static_cast<std::uint32_t>(unknowns_.size()));
    const auto elements =
        static_cast<std::uint32_t>(room.access_points[i].array.element_offset.size());
    elements_.push_back(elements);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      unknowns_.push_back({Kind::kArrayPosition, i, axis, priors.position});
    }
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      unknowns_.push_back({Kind::kArrayAngle, i, axis, priors.angle});
    }
    for (std::uint32_t e = 0; e < elements; ++e) {
      unknowns_.push_back({Kind::kElementPosition, i, e, priors.element});
    }
    for (std::uint32_t e = 1; e < elements; ++e) {
      unknowns_.push_back({Kind::kChainGain, i, e, priors.chain});
      unknowns_.push_back({Kind::kChainPhase, i, e, priors.chain});
    }
    for (std::uint32_t part = 0; part < 2 * elements * (elements - 1); ++part) {
      unknowns_.push_back({Kind::kCoupling, i, part, priors.coupling});
    }
  }
}

std::uint32_t RoomUnknowns::chain_gain(std::size_t access_point, std::size_t element) const {
  RAYLOC_CHECK(element > 0);
  return arrays_at_[access_point] + 6 + static_cast<std::uint32_t>(elements_[access_point]) +
         2 * static_cast<std::uint32_t>(element - 1);
}

std::uint32_t RoomUnknowns::coupling(std::size_t access_point) const {
  const auto elements = static_cast<std::uint32_t>(elements_[access_point]);
  return arrays_at_[access_point] + 6 + elements + 2 * (elements - 1);
}

Expected<RoomModel> changed_room(const RoomModel& original,
                                 const RoomUnknowns& unknowns,
                                 const std::vector<double>& values) {
  auto moved =
      move_surfaces(*original.scene, std::span(values).first(original.scene->surfaces().size()));
  RAYLOC_TRY(moved);
  Scene::Input input{moved->objects(), moved->materials(), moved->carrier_hz()};
  for (std::uint32_t m = 0; m < input.materials.size(); ++m) {
    RadioMaterial& material = input.materials[m];
    const double* value = &values[unknowns.permittivity(m)];
    material.relative_permittivity =
        std::max(1.0, material.relative_permittivity * std::exp(value[0]));
    material.conductivity *= std::exp(value[1]);
    material.thickness *= std::exp(value[2]);
  }
  auto scene = Scene::create(std::move(input));
  RAYLOC_TRY(scene);
  RoomModel room = original;
  room.scene = std::make_shared<const Scene>(*std::move(scene));
  room.surface_correction.resize(room.scene->surfaces().size());
  for (std::uint32_t s = 0; s < room.surface_correction.size(); ++s) {
    room.surface_correction[s] =
        std::polar(std::exp(values[unknowns.surface_gain(s)]), values[unknowns.surface_phase(s)]);
  }
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    RoomAccessPoint& ap = room.access_points[i];
    const double* position = &values[unknowns.array_position(i)];
    const double* angle = &values[unknowns.array_angle(i)];
    ap.array.pose.position = ap.array.pose.position + Vec3d{position[0], position[1], position[2]};
    ap.array.pose.orientation.yaw += angle[0];
    ap.array.pose.orientation.pitch += angle[1];
    ap.array.pose.orientation.roll += angle[2];
    const std::size_t tones = ap.gains.grid.size();
    for (std::size_t e = 0; e < ap.array.element_offset.size(); ++e) {
      ap.array.element_offset[e].y += values[unknowns.element_position(i, e)];
      for (std::size_t k = 0; e > 0 && !ap.gains.empty() && k < tones; ++k) {
        const double* chain = &values[unknowns.chain_gain(i, e)];
        ap.gains.gain[e * tones + k] *= std::polar(std::exp(chain[0]), chain[1]);
      }
    }
    set_coupling(&values[unknowns.coupling(i)], ap.gains);
  }
  return room;
}

ParameterId parameter_id(const Unknown& unknown, const RoomModel& room) {
  // The quantities of Unknown::part, in its order.
  constexpr std::array kAxes{Quantity::kPositionX, Quantity::kPositionY, Quantity::kPositionZ};
  // Likewise in the order of angles.
  constexpr std::array kAngles{Quantity::kYaw, Quantity::kPitch, Quantity::kRoll};
  const auto access_point = [&] { return room.access_points[unknown.index].id; };
  const auto material = [&] { return room.scene->materials()[unknown.index].name; };
  const auto surface = [&] { return surface_name(*room.scene, unknown.index); };
  const auto chain = [&] {
    const auto& rx_chains = room.access_points[unknown.index].rx_chains;
    return access_point() + ".core" + std::to_string(rx_chains[unknown.part]);
  };
  const auto against_the_first = [&] {
    return chain() + "/core" + std::to_string(room.access_points[unknown.index].rx_chains.front());
  };
  switch (unknown.kind) {
    case Kind::kSurfaceOffset:
      return {surface(), Quantity::kSurfaceOffset};
    case Kind::kSurfaceGain:
      return {surface(), Quantity::kGain};
    case Kind::kSurfacePhase:
      return {surface(), Quantity::kPhase};
    case Kind::kPermittivity:
      return {material(), Quantity::kRelativePermittivity};
    case Kind::kConductivity:
      return {material(), Quantity::kConductivity};
    case Kind::kThickness:
      return {material(), Quantity::kThickness};
    case Kind::kArrayPosition:
      return {access_point(), kAxes.at(unknown.part)};
    case Kind::kArrayAngle:
      return {access_point(), kAngles.at(unknown.part)};
    case Kind::kElementPosition:
      return {chain(), Quantity::kElementY};
    case Kind::kChainGain:
      return {against_the_first(), Quantity::kGain};
    case Kind::kCoupling:
      return coupling_id(unknown, room.access_points[unknown.index]);
    case Kind::kChainPhase:
      break;
  }
  return {against_the_first(), Quantity::kPhase};
}

}  // namespace rayloc
