#include "daemon/site/scene/room_site.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/scene/access_point_presets.h"

namespace rayloc {
namespace {

// Default position of an access point that is not specified: in a corner below the ceiling.
constexpr double kFromWalls = 0.3;     // [m], chosen
constexpr double kUsualHeight = 2.2;   // [m], chosen
constexpr double kBelowCeiling = 0.3;  // [m], chosen

struct AccessPointPlace {
  Vec3d position;  // [m]
  double yaw_deg;
};

// In the first corner of the room with enough space, facing the room's centre.
AccessPointPlace usual_place(const RoomPlan& plan) {
  const Vec3d& low = plan.lower;
  const Vec3d& high = plan.upper;
  std::vector<FloorPoint> outline{
      {low.x, low.y}, {high.x, low.y}, {high.x, high.y}, {low.x, high.y}};
  PlanRoom room{.outline = outline, .level = low.z, .height = high.z};
  if (!plan.rooms.empty()) {
    room = plan.rooms.front();
  }
  const std::size_t n = room.outline.size();
  FloorPoint middle{};
  for (const FloorPoint& corner : room.outline) {
    middle = {middle[0] + corner[0] / static_cast<double>(n),
              middle[1] + corner[1] / static_cast<double>(n)};
  }
  FloorPoint at = middle;
  for (std::size_t i = 0; i < n; ++i) {
    const FloorPoint& corner = room.outline[i];
    const FloorPoint& before = room.outline[(i + n - 1) % n];
    const FloorPoint& after = room.outline[(i + 1) % n];
    FloorPoint inwards = corner;
    for (const FloorPoint& neighbour : {before, after}) {
      const double length = std::hypot(neighbour[0] - corner[0], neighbour[1] - corner[1]);
      inwards = {inwards[0] + kFromWalls * (neighbour[0] - corner[0]) / length,
                 inwards[1] + kFromWalls * (neighbour[1] - corner[1]) / length};
    }
    if (is_within(room.outline, inwards, 0.0)) {
      at = inwards;
      break;
    }
  }
  const double ceiling = room.ceiling_at(at) - kBelowCeiling;
  const auto rounded = [](double value) { return std::round(value * 100.0) / 100.0; };
  const double yaw = std::atan2(middle[1] - at[1], middle[0] - at[0]) * 180.0 / std::numbers::pi;
  return {{rounded(at[0]),
           rounded(at[1]),
           rounded(std::max(std::min(room.level + kUsualHeight, ceiling),
                            0.5 * (room.level + ceiling + kBelowCeiling)))},
          std::round(yaw)};
}

// An access point in a corner of the room, with the antennas of a known model.
std::string access_point_block(const RoomPlan& plan, const AntennaPreset& preset) {
  const AccessPointPlace place = usual_place(plan);
  std::string text = fmt::format(
      "[[access_point]]  # {}, {}\nid = \"ap1\"\n"
      "position = [{}, {}, {}]  # middle antenna, metres: write its position\n"
      "yaw_deg = {}  # direction it faces: anticlockwise from +x\n",
      preset.model,
      preset.remark,
      place.position.x,
      place.position.y,
      place.position.z,
      place.yaw_deg);
  double y = -preset.spacing_m;
  for (const int rx_chain : preset.rx_chains) {
    text += fmt::format(
        "[[access_point.antenna]]{}\ncore = {}\noffset = [0, {}, 0]\n",
        y < 0.0 ? "  # from the access point: +x is the direction it faces, +y its left" : "",
        rx_chain,
        y);
    y += preset.spacing_m;
  }
  return text;
}

std::string commented(const std::string& text) {
  std::string lines = "# ";
  for (std::size_t i = 0; i < text.size(); ++i) {
    lines += text[i];
    lines += text[i] == '\n' && i + 1 < text.size() ? "# " : "";
  }
  return lines;
}

std::string access_point_example(const RoomPlan& plan) {
  return "# State each access point and the places of its antennas: then this folder is a site. "
         "Without its\n# \"# \" this one is ready, in a corner of the room (--access-point states "
         "its model).\n" +
         commented(access_point_block(plan, kAntennaPresets.front()));
}

// A TOML string of a name without control characters.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') {
      text += '\\';
    }
    text += c;
  }
  return text + "\"";
}

std::string degrees(double radians) {
  // Twelve digits: a value stated in degrees is printed unchanged.
  return fmt::format("{:.12g}", radians * 180.0 / std::numbers::pi);
}

// The runs of neighbouring tones: "[[-58, -2], [2, 58]]".
std::string active_text(const std::vector<std::int16_t>& tones) {
  std::vector<std::string> runs;
  for (std::size_t first = 0; first < tones.size();) {
    std::size_t last = first;
    while (last + 1 < tones.size() && tones[last + 1] == tones[last] + 1) {
      ++last;
    }
    runs.push_back(fmt::format("[{}, {}]", tones[first], tones[last]));
    first = last + 1;
  }
  return fmt::format("[{}]", fmt::join(runs, ", "));
}

std::string carrier_text(const Carrier& carrier) {
  std::string text = "\n[carrier]  # channel of the access points\n";
  if (carrier.channel != 0) {
    text += fmt::format("channel = {}\n", carrier.channel);
  }
  return text + fmt::format(
                    "bandwidth_mhz = {}\ncentre_hz = {:.17g}\ntones = {:.0f}\n"
                    "tone_spacing_hz = {:.17g}\nactive = {}\n",
                    carrier.bandwidth_mhz,
                    carrier.grid.centre_hz,
                    carrier.bandwidth_mhz * 1e6 / carrier.grid.spacing_hz,
                    carrier.grid.spacing_hz,
                    active_text(carrier.grid.tone_index));
}

std::string vector_text(const Vec3d& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }

std::string pattern_file_name(const SiteAccessPoint& ap) { return "patterns/" + ap.id + ".csv"; }

std::string pattern_text(const SiteAccessPoint& ap) {
  return ap.array.pattern.kind() == AntennaPattern::kTable
             ? fmt::format("pattern_file = \"{}\"", pattern_file_name(ap))
             : fmt::format("pattern = \"{}\"", to_string(ap.array.pattern));
}

std::string access_point_text(const SiteAccessPoint& ap) {
  const Orientation& o = ap.array.pose.orientation;
  std::string text = fmt::format("\n[[access_point]]\nid = {}\n", quoted(ap.id));
  if (!ap.format.empty()) {
    text += fmt::format("format = {}\n", quoted(ap.format));
  }
  text += fmt::format(
      "position = {}\nyaw_deg = {}\npitch_deg = {}\nroll_deg = {}\n{}\n"
      "polarization = \"{}\"\n",
      vector_text(ap.array.pose.position),
      degrees(o.yaw),
      degrees(o.pitch),
      degrees(o.roll),
      pattern_text(ap),
      ap.array.polarization == Polarization::kVertical ? "V" : "H");
  for (std::size_t i = 0; i < ap.rx_chains.size(); ++i) {
    text += fmt::format("[[access_point.antenna]]\ncore = {}\noffset = {}\n",
                        ap.rx_chains[i],
                        vector_text(ap.array.element_offset[i]));
  }
  return text;
}

}  // namespace

std::string room_site(const RoomPlan& plan, std::string_view model) {
  std::string text = fmt::format(
      "name = {}\nscene = \"scene.xml\"\n\n[bounds]  # metres, room coordinates\n"
      "x = [{}, {}]\ny = [{}, {}]\nz = [{}, {}]\n",
      quoted(plan.name),
      plan.lower.x,
      plan.upper.x,
      plan.lower.y,
      plan.upper.y,
      plan.lower.z,
      plan.upper.z);
  text += carrier_text(plan.carrier);
  for (const SiteAccessPoint& ap : plan.access_points) {
    text += access_point_text(ap);
  }
  if (!model.empty()) {
    return text + "\n" + access_point_block(plan, preset_of(model));
  }
  return plan.access_points.empty() ? text + "\n" + access_point_example(plan) : text;
}

std::map<std::string, std::filesystem::path> room_pattern_files(const RoomPlan& plan) {
  std::map<std::string, std::filesystem::path> files;
  for (const SiteAccessPoint& ap : plan.access_points) {
    if (ap.array.pattern.kind() == AntennaPattern::kTable) {
      files[pattern_file_name(ap)] = ap.array.pattern.table().name();
    }
  }
  return files;
}

}  // namespace rayloc
