#include "daemon/scene/room_site.h"

#include <cstdint>
#include <numbers>
#include <vector>

#include <spdlog/fmt/fmt.h>

namespace rayloc {
namespace {

// Of an access point that the plan does not name.
constexpr const char* kAccessPointExample =
    R"(# Name each access point, and where its antennas are: then this folder is a site.
# [[access_point]]
# id = "ap1"
# position = [0.3, 0.3, 2.2]  # the middle of the antennas, metres
# yaw_deg = 45                # where it looks: anticlockwise from +x
# [[access_point.antenna]]    # local frame: +x is where it looks, +y its left
# core = 0
# offset = [0, -0.089, 0]
# [[access_point.antenna]]
# core = 1
# offset = [0, 0, 0]
# [[access_point.antenna]]
# core = 2
# offset = [0, 0.089, 0]
)";

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
  // Twelve digits: what was written in degrees comes out as it was written.
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
  std::string text = "\n[carrier]  # what the access points measure on\n";
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
  for (std::size_t i = 0; i < ap.cores.size(); ++i) {
    text += fmt::format("[[access_point.antenna]]\ncore = {}\noffset = {}\n",
                        ap.cores[i],
                        vector_text(ap.array.element_offset[i]));
  }
  return text;
}

}  // namespace

std::string room_site(const RoomPlan& plan) {
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
  return plan.access_points.empty() ? text + "\n" + kAccessPointExample : text;
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
