#include "daemon/cli/arguments/link_arguments.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "daemon/cli/arguments/number_list.h"
#include "engine/base/suggestion.h"

namespace rayloc::cli {
namespace {

// More reflections than are observable, and few enough for the memory with a small scene.
constexpr int kMaxDepth = 16;

// "A" or "A,B": for both ends, or for the transmitter and the receiver.
std::pair<std::string, std::string> of_both_ends(const std::string& text) {
  const std::size_t comma = text.find(',');
  return comma == std::string::npos ? std::pair(text, text)
                                    : std::pair(text.substr(0, comma), text.substr(comma + 1));
}

Expected<AntennaPattern> parse_pattern(const std::string& name) {
  if (const auto pattern = parse_antenna_pattern(name)) {
    return *pattern;
  }
  return make_error(ErrorKind::kUsage,
                    "--pattern: there is no antenna pattern '" + name + "'" +
                        suggestion(name, std::span<const std::string_view>(kAntennaPatternNames)));
}

Expected<Polarization> parse_polarization(const std::string& name) {
  if (name == "V" || name == "H") {
    return name == "V" ? Polarization::kVertical : Polarization::kHorizontal;
  }
  return make_error(ErrorKind::kUsage, "--polarization " + name + ": write V or H");
}

Expected<Orientation> parse_orientation(const std::string& option, const std::string& text) {
  std::array<double, 3> v{};
  if (!text.empty()) {
    RAYLOC_TRY(parse_number_list(option, text, "0.3,0,0", v));
  }
  return Orientation{v[0], v[1], v[2]};
}

struct EndText {
  std::string option, position;
  std::string orientation_option, orientation;
  std::string pattern, polarization;
};

Expected<RadioDevice> parse_end(const EndText& text) {
  const auto position = parse_point(text.option, text.position);
  RAYLOC_TRY(position);
  const auto orientation = parse_orientation(text.orientation_option, text.orientation);
  RAYLOC_TRY(orientation);
  const auto pattern = parse_pattern(text.pattern);
  RAYLOC_TRY(pattern);
  const auto polarization = parse_polarization(text.polarization);
  RAYLOC_TRY(polarization);
  return RadioDevice{*position, *orientation, *pattern, *polarization, {}};
}

}  // namespace

void declare_scene(OptionParser& app, std::string& scene, std::optional<double>& frequency) {
  app.add_option("SCENE", scene, "Mitsuba XML, or a site: a directory with site.toml")->required();
  app.add_option("--frequency",
                 frequency,
                 "Carrier at which materials and antennas are evaluated [Hz]; default: the site's, "
                 "else 5.18e9")
      ->check(positive());
}

void declare_paths(OptionParser& app, TraceOptions& options) {
  app.add_option("--depth", options.max_depth, "Most interactions of a path")
      ->check(in_range(0, kMaxDepth))
      ->capture_default_str();
  app.add_flag("--transmission",
               options.transmission,
               "Also through objects; each face that is crossed counts for the depth");
  const ParserOption* const one = app.add_flag(
      "--diffraction",
      options.diffraction,
      "Also round one edge, with up to two other interactions before it and after it; the edge "
      "counts for the depth. Not with --soft");
  app.add_flag("--double-diffraction",
               options.double_diffraction,
               "With --diffraction: also round two edges in a row, which both count; takes longer "
               "as the number of edges squared")
      ->needs(one);
}

void declare_link(OptionParser& app, LinkArguments& arguments) {
  declare_scene(app, arguments.scene, arguments.frequency);
  app.add_option("--tx", arguments.tx, "Position of the transmitter, x,y,z [m]");
  app.add_option("--rx", arguments.rx, "Position of the receiver, x,y,z [m]");
  declare_paths(app, arguments.options);
  app.add_option("--soft",
                 arguments.options.softness,
                 "Soft visibility: distance from its edge over which a face begins to reflect and "
                 "to shadow [m]; 0 is hard")
      ->check(in_range(0.0, 10.0))
      ->capture_default_str();
}

void declare_antennas(OptionParser& app, LinkArguments& arguments) {
  app.add_option("--pattern",
                 arguments.pattern,
                 "Antenna: isotropic, dipole, half_wave_dipole or tr38901; TX,RX when they differ")
      ->capture_default_str();
  app.add_option("--polarization", arguments.polarization, "V or H; TX,RX when they differ")
      ->capture_default_str();
  app.add_option("--orientation-tx",
                 arguments.orientation_tx,
                 "Yaw, pitch, roll of the transmitter about z, y, x [rad]");
  app.add_option("--orientation-rx", arguments.orientation_rx, "As well of the receiver");
}

Expected<Link> parse_link(const LinkArguments& arguments) {
  if (!std::isfinite(arguments.options.softness)) {  // no range of CLI11 excludes NaN
    return make_error(ErrorKind::kUsage, "--soft must be a number of metres");
  }
  if (arguments.options.softness > 0.0 && arguments.options.diffraction) {
    return make_error(ErrorKind::kUsage,
                      "--diffraction goes with hard edges only: leave --soft out");
  }
  const auto [pattern_tx, pattern_rx] = of_both_ends(arguments.pattern);
  const auto [polarization_tx, polarization_rx] = of_both_ends(arguments.polarization);
  const auto tx = parse_end({"--tx",
                             arguments.tx,
                             "--orientation-tx",
                             arguments.orientation_tx,
                             pattern_tx,
                             polarization_tx});
  RAYLOC_TRY(tx);
  const auto rx = parse_end({"--rx",
                             arguments.rx,
                             "--orientation-rx",
                             arguments.orientation_rx,
                             pattern_rx,
                             polarization_rx});
  RAYLOC_TRY(rx);
  if (tx->position == rx->position) {
    return make_error(ErrorKind::kUsage,
                      "--tx and --rx are the same point; give two different points");
  }
  return Link{Transmitter{*tx}, Receiver{*rx}};
}

}  // namespace rayloc::cli
