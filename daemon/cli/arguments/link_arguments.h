// The link that `rayloc trace` and `rayloc scene show` evaluate: a scene, two antennas, and the
// selection of paths between them.
#pragma once

#include <optional>
#include <string>

#include "daemon/cli/command/option_parser.h"
#include "daemon/lab/trace/trace_link.h"
#include "daemon/site/scene/scene_source.h"
#include "engine/base/expected.h"
#include "engine/trace/trace_options.h"

namespace rayloc::cli {

// Values as written on the command line.
struct LinkArguments {
  std::string scene;
  std::optional<double> frequency;
  std::string tx;
  std::string rx;
  TraceOptions options;
  std::string pattern = "isotropic";
  std::string polarization = "V";
  std::string orientation_tx;
  std::string orientation_rx;
};

// Adds SCENE and --frequency; the first is required.
void declare_scene(OptionParser& app, std::string& scene, std::optional<double>& frequency);
// Adds --depth, --transmission, --diffraction and --double-diffraction.
void declare_paths(OptionParser& app, TraceOptions& options);
// Adds SCENE, --frequency, --tx, --rx, --depth, --transmission, --diffraction and --soft; the first
// is required.
void declare_link(OptionParser& app, LinkArguments& arguments);
// Adds --pattern, --polarization, --orientation-tx and --orientation-rx.
void declare_antennas(OptionParser& app, LinkArguments& arguments);

// The antennas at two distinct positions. Errors are of kind kUsage.
Expected<Link> parse_link(const LinkArguments& arguments);

}  // namespace rayloc::cli
