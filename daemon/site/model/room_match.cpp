#include "daemon/site/model/room_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/model/keys/site_limits.h"
#include "daemon/site/model/length_unit.h"
#include "daemon/site/model/scene_frame.h"
#include "daemon/site/model/upright.h"

namespace rayloc {
namespace {

constexpr std::string_view kAxes = "xyz";
// Rooms, flats, halls, floors of offices. Outside this range the unit is probably not the metre.
constexpr double kSmallestPlace = 0.5;  // [m]
constexpr double kLargestPlace = 100;   // [m]
// An antenna may be this far outside all meshes: before the outer face of a wall, on a mast.
constexpr double kOutsideSlack = 1.0;  // [m]
// [bounds] may extend this far out of the scene: to the middle of a wall.
constexpr double kBoundsSlack = 0.5;  // [m]
constexpr int kMinSureSides = 4;      // of [bounds] on faces: the identity of the room is certain

Bounds box_of(const Scene& scene) { return {scene.bounds_min(), scene.bounds_max()}; }

double longest(const Vec3d& size) { return std::max({size.x, size.y, size.z}); }

// Distance from the box [m]; 0 inside.
double distance_outside(const Bounds& box, const Vec3d& p) {
  const auto beyond = [](double low, double high, double value) {
    return std::max({low - value, value - high, 0.0});
  };
  return norm(Vec3d{beyond(box.lower.x, box.upper.x, p.x),
                    beyond(box.lower.y, box.upper.y, p.y),
                    beyond(box.lower.z, box.upper.z, p.z)});
}

bool all_inside(const Bounds& box, const std::vector<SiteAntenna>& antennas, double scale) {
  constexpr double kSlack = 0.3;  // [m]
  return std::all_of(antennas.begin(), antennas.end(), [&](const SiteAntenna& antenna) {
    return distance_outside(box, scale * antenna.place) <= kSlack;
  });
}

// Values in metres would not: a mistake in one coordinate leaves the others unchanged.
bool all_above(const Bounds& box, const std::vector<SiteAntenna>& antennas) {
  constexpr double kClearly = 1.2;
  return std::all_of(antennas.begin(), antennas.end(), [&](const SiteAntenna& antenna) {
    return box.upper.z > 0.0 && antenna.place.z > kClearly * box.upper.z;
  });
}

// The unit in which a scene of that size would be a usual room, judged by its height.
const LengthUnit* likely_unit(const Vec3d& size) {
  constexpr double kLowest = 1.8;    // [m]
  constexpr double kHighest = 12.0;  // [m]
  constexpr double kUsual = 2.7;     // [m]
  const LengthUnit* best = nullptr;
  double least = 0.0;
  for (const LengthUnit& unit : kMistakenUnits) {
    const double height = unit.metres * size.z;
    const double off = std::abs(std::log(height / kUsual));
    if (height > kLowest && height < kHighest && unit.metres * longest(size) < kLargestPlace &&
        (best == nullptr || off < least)) {
      best = &unit;
      least = off;
    }
  }
  return best;
}

std::string scale_advice(double scale) {
  return fmt::format(
      "multiply its vertices by {0:.4g} (export it in metres, or write <scale value=\"{0:.4g}\"/> "
      "last in to_world of each shape)",
      scale);
}

// Names the lengths that are not metres: those of the larger box, unless the smaller one is no
// room. `scale`: the factor for the vertices.
std::string unit_text(const Scene& scene, double scale) {
  const auto off = [&](const LengthUnit& unit) {
    return std::abs(std::abs(std::log(unit.metres)) - std::abs(std::log(scale)));
  };
  const auto unit = std::min_element(
      kMistakenUnits.begin(), kMistakenUnits.end(), [&](const LengthUnit& a, const LengthUnit& b) {
        return off(a) < off(b);
      });
  if (scale < 1.0) {
    return fmt::format("its vertices are in {}; {}", unit->name, scale_advice(scale));
  }
  const Vec3d size = box_of(scene).size();
  if (std::min({size.x, size.y, size.z}) < kSmallestPlace) {
    return fmt::format("it is {:.4g} times too small, as metres that were taken for {}; {}",
                       scale,
                       unit->name,
                       scale_advice(scale));
  }
  return fmt::format("the lengths of the site are in {}; write metres", unit->name);
}

std::string axes_text(const SceneFrame& frame) {
  std::string text;
  for (std::size_t i = 0; i < 3; ++i) {
    const SceneFrame::Axis& axis = frame.axes.at(i);
    if (axis.of_scene != i || axis.sign < 0.0) {
      text += fmt::format("{}{} of the room is {}{} of the scene",
                          text.empty() ? "" : ", ",
                          kAxes[i],
                          axis.sign < 0.0 ? "-" : "",
                          kAxes[axis.of_scene]);
    }
  }
  return text;
}

// Advice for a scene whose floor and ceiling are perpendicular to that axis.
std::string up_advice(std::size_t axis) {
  return fmt::format(
      "exchange {0} and z: export it with z up, or write <rotate {1}=\"1\" angle=\"{2}\"/> last in "
      "to_world of each shape",
      kAxes[axis],
      axis == 1 ? 'x' : 'y',
      axis == 1 ? 90 : -90);
}

// A room from 0 to -4 m was shifted or mirrored. Its box does not distinguish the two.
std::string mirror_text(const Bounds& box, const Bounds& room) {
  constexpr double kSame = 0.3;  // [m]
  std::string axes;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto along = [&](const Vec3d& v) { return i == 0 ? v.x : i == 1 ? v.y : v.z; };
    if (std::abs(along(box.lower) - along(room.lower)) < kSame) {
      continue;
    }
    if (std::abs(along(box.lower) + along(room.upper)) > kSame ||
        std::abs(along(box.upper) + along(room.lower)) > kSame) {
      return "";
    }
    axes += fmt::format("{}{}", axes.empty() ? "" : ", ", kAxes[i]);
  }
  return axes.empty() ? "" : fmt::format("; or is the sign of {} wrong?", axes);
}

// The one finding about a scene that is the stated room in another frame.
RoomFinding frame_finding(const Scene& scene, const Bounds& room, const SceneFrame& frame) {
  const Bounds box = box_of(scene);
  RoomFinding finding;
  finding.is_error = true;
  finding.kind = frame.is_scaled() ? "unit" : frame.is_rotated() ? "axes" : "origin";
  finding.message = fmt::format("the scene is not the room that [bounds] states ({} instead of {})",
                                size_text(box.size()),
                                size_text(room.size()));
  if (frame.is_scaled()) {
    finding.message += ": " + unit_text(scene, frame.scale);
  }
  if (frame.is_rotated()) {
    const std::size_t up = frame.axes[2].of_scene;
    finding.message += ": " + axes_text(frame);
    finding.message +=
        up == 2 ? "; turn the scene, or correct [bounds] and all positions"
                : fmt::format("; its floor and ceiling lie along {}: {}", kAxes[up], up_advice(up));
  }
  if (frame.is_shifted()) {
    finding.message += fmt::format(
        ": its origin is another one; move it by {:.3f}, {:.3f}, {:.3f} m (<translate> last in "
        "to_world of each shape), or correct [bounds] and all positions",
        frame.shift.x,
        frame.shift.y,
        frame.shift.z);
    finding.message += frame.is_scaled() || frame.is_rotated() ? "" : mirror_text(box, room);
  }
  return finding;
}

class RoomMatch {
 public:
  RoomMatch(const Scene& scene, const Site* site) : scene_(scene), box_(box_of(scene)) {
    if (site != nullptr) {
      antennas_ = antennas_of(*site);
      if (site->has_bounds) {
        room_ = Bounds{site->bounds_min, site->bounds_max};
      }
      has_site_ = true;
    }
  }

  std::vector<RoomFinding> findings() {
    if (room_) {
      compare_with_bounds();
    } else if (const auto named = wrong_up_by_name(scene_); named && named->certain && has_site_) {
      add_named_up(*named, true);
    } else {
      judge_size();
    }
    if (findings_.empty() && !sure_) {
      judge_upright();
    }
    const bool explained = std::any_of(
        findings_.begin(), findings_.end(), [](const auto& each) { return each.is_error; });
    if (!explained) {
      find_antennas_outside();
    }
    return std::move(findings_);
  }

 private:
  void add(bool is_error, std::string kind, std::string message) {
    findings_.push_back({is_error, std::move(kind), std::move(message)});
  }

  void compare_with_bounds() {
    if (const auto frame = find_frame(scene_, *room_)) {
      findings_.push_back(frame_finding(scene_, *room_, *frame));
      return;
    }
    sure_ = covered_sides(scene_, {}, *room_) >= kMinSureSides;
    if (!sure_) {
      judge_size();
    }
    if (findings_.empty()) {
      find_bounds_outside();
    }
  }

  void find_bounds_outside() {
    constexpr std::array<double Vec3d::*, 3> kOf = {&Vec3d::x, &Vec3d::y, &Vec3d::z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = box_.lower.*kOf.at(axis) - kBoundsSlack;
      const double high = box_.upper.*kOf.at(axis) + kBoundsSlack;
      const double from = room_->lower.*kOf.at(axis);
      const double to = room_->upper.*kOf.at(axis);
      const bool apart = to < low || from > high;
      // In the open air no object is as high as the room.
      const bool beyond = from < low || (to > high && axis != 2);
      if (apart || beyond) {
        add(apart,
            "bounds",
            fmt::format("[bounds] states {0} from {1:.6g} to {2:.6g} m, and the scene {3} from "
                        "{4:.6g} to {5:.6g} m: {6}",
                        kAxes[axis],
                        from,
                        to,
                        apart ? "lies apart from it," : "is smaller,",
                        box_.lower.*kOf.at(axis),
                        box_.upper.*kOf.at(axis),
                        apart ? "both need one origin" : "the paths beyond it are unknown"));
        return;
      }
    }
  }

  // For sites without [bounds], or with bounds that coincide with no wall.
  void judge_size() {
    const Vec3d size = box_.size();
    if (!room_ && !antennas_.empty() && judge_site_unit()) {
      return;
    }
    if (longest(size) > kLargestPlace) {
      const LengthUnit* unit = likely_unit(size);
      std::string text = fmt::format("the scene is {}", size_text(size));
      if (unit == nullptr) {
        add(false, "scale", text + " large: are its vertices in metres?");
        return;
      }
      const Bounds metres{unit->metres * box_.lower, unit->metres * box_.upper};
      const bool is_error = has_site_ && !room_ && all_inside(metres, antennas_, 1.0);
      text += fmt::format(" large; in {} it would be {}: {}",
                          unit->name,
                          size_text(metres.size()),
                          scale_advice(unit->metres));
      add(is_error,
          is_error ? "unit" : "scale",
          text + (is_error ? "; where it is right, state [bounds] of the room" : ""));
    } else if (longest(size) < kSmallestPlace) {
      add(false,
          "scale",
          fmt::format("the scene is {} large: are its vertices in metres?", size_text(size)));
    } else if (!has_site_ && distance_outside(box_, {}) > kFarthest) {
      add(false,
          "origin",
          fmt::format("the scene lies {:.0f} km from its origin, and a site can state places up to "
                      "10 km: move it (<translate> last in to_world of each shape); vertices that "
                      "are stored as float are rounded to {:.2g} m there",
                      distance_outside(box_, {}) / 1000.0,
                      distance_outside(box_, {}) * 0x1p-24));
    }
  }

  // Returns true if another unit brings all antennas into the scene.
  bool judge_site_unit() {
    if (!all_above(box_, antennas_)) {
      return false;
    }
    for (const LengthUnit& unit : kMistakenUnits) {
      if (all_inside(box_, antennas_, unit.metres)) {
        add(true,
            "unit",
            fmt::format("all antennas of the site are above the scene ({}): {}",
                        size_text(box_.size()),
                        unit_text(scene_, 1.0 / unit.metres)));
        return true;
      }
    }
    return false;
  }

  void add_named_up(const NamedUp& named, bool is_error) {
    add(is_error,
        "axes",
        fmt::format("an object that is named a floor or a ceiling is upright, across {}: {}",
                    kAxes[named.axis],
                    up_advice(named.axis)));
  }

  void judge_upright() {
    if (const auto named = wrong_up_by_name(scene_)) {
      add_named_up(*named, false);
      return;
    }
    const int horizontal = large_faces(scene_, 2);
    if (horizontal == 0) {
      const bool y = large_faces(scene_, 1) == 2;
      const bool x = large_faces(scene_, 0) == 2;
      if (x || y) {
        add(false,
            "axes",
            fmt::format("no large horizontal face, but a pair across {}: if they are floor and "
                        "ceiling, {}",
                        y ? 'y' : 'x',
                        up_advice(y ? 1 : 0)));
        return;
      }
    }
    if (horizontal < 2 && !has_site_) {
      add(false,
          "no_ceiling",
          "no pair of large horizontal faces: a floor, a ceiling or both are missing, and with "
          "them the paths that they reflect; right in the open air only");
    }
  }

  void find_antennas_outside() {
    for (const SiteAntenna& antenna : antennas_) {
      const double outside = distance_outside(box_, antenna.place);
      if (outside > kOutsideSlack) {
        // A wave may pass a wall from the street, but not from the next block.
        add(outside > norm(box_.size()),
            "antenna_outside",
            fmt::format("{} is {:.1f} m outside of the scene, at {:.6g}, {:.6g}, {:.6g}",
                        antenna.name,
                        outside,
                        antenna.place.x,
                        antenna.place.y,
                        antenna.place.z));
      }
    }
  }

  const Scene& scene_;
  Bounds box_;
  bool has_site_ = false;
  std::optional<Bounds> room_;  // as stated
  std::vector<SiteAntenna> antennas_;
  bool sure_ = false;  // the scene is certainly the stated room
  std::vector<RoomFinding> findings_;
};

}  // namespace

std::vector<SiteAntenna> antennas_of(const Site& site) {
  std::vector<SiteAntenna> antennas;
  for (const SiteAccessPoint& ap : site.access_points) {
    for (std::size_t i = 0; i < ap.rx_chains.size(); ++i) {
      antennas.push_back({fmt::format("the antenna of core {} of access point '{}'",
                                      static_cast<int>(ap.rx_chains[i]),
                                      ap.id),
                          element_position(ap.array, i)});
    }
  }
  for (const SiteTransmitter& transmitter : site.transmitters) {
    if (transmitter.position) {
      antennas.push_back(
          {"the fixed transmitter " + to_string(transmitter.mac), *transmitter.position});
    }
  }
  return antennas;
}

std::vector<RoomFinding> room_findings(const Scene& scene, const Site* site) {
  return RoomMatch(scene, site).findings();
}

Expected<void> check_room(const Scene& scene, const Site& site) {
  std::string errors;
  for (const RoomFinding& finding : room_findings(scene, &site)) {
    if (finding.is_error) {
      errors += (errors.empty() ? "" : "\n") + site.scene_file.string() + ": " + finding.message;
    }
  }
  return errors.empty() ? Expected<void>()
                        : make_error(ErrorKind::kConfiguration, std::move(errors));
}

std::vector<std::string> room_warnings(const Scene& scene, const Site& site) {
  std::vector<std::string> warnings;
  for (const RoomFinding& finding : room_findings(scene, &site)) {
    if (!finding.is_error) {
      warnings.push_back(site.scene_file.string() + ": warning: " + finding.message);
    }
  }
  const Vec3d lower = site.has_bounds ? site.bounds_min : scene.bounds_min();
  const Vec3d upper = site.has_bounds ? site.bounds_max : scene.bounds_max();
  for (std::string& warning : zone_warnings(site, lower, upper)) {
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

}  // namespace rayloc
