// `rayloc trace`: the paths between two antennas, their channel and its derivatives.
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "daemon/base/arrays/npz_file.h"
#include "daemon/cli/arguments/gradient_argument.h"
#include "daemon/cli/arguments/link_arguments.h"
#include "daemon/cli/arguments/number_list.h"
#include "daemon/cli/arguments/trace_arrays.h"
#include "daemon/cli/arguments/trace_report.h"
#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/site/scene/scene_notes.h"
#include "engine/base/printable.h"
#include "engine/trace/diffuse/diffuse_tracer.h"
#include "engine/trace/path_tracer.h"

namespace rayloc::cli {
namespace {

struct TraceArguments {
  LinkArguments link;
  std::string cfr;
  std::string gradient;
  std::string out;
  DiffuseOptions diffuse;
  bool json = false;
};

// The tones CENTRE + (j - COUNT / 2) SPACING, as those of 802.11 are numbered.
Expected<OfdmGrid> parse_grid(const std::string& text) {
  constexpr double kMaxTones = 65'536;
  std::array<double, 3> v{};
  const std::string example = "5.19e9,312500,128";
  if (auto parsed = parse_number_list("--cfr", text, example, v); !parsed) {
    return tl::make_unexpected(parsed.error());
  }
  const auto [centre, spacing, count] = v;
  if (!(centre > 0.0) || !(spacing > 0.0) || count != std::trunc(count) || count < 1.0 ||
      count > kMaxTones) {
    return make_error(ErrorKind::kUsage,
                      "--cfr " + text +
                          ": write the centre and the spacing of the tones in Hz, and their number "
                          "from 1 to 65536: --cfr " +
                          example);
  }
  OfdmGrid grid{centre, spacing, {}};
  const int tones = static_cast<int>(count);
  for (int j = 0; j < tones; ++j) {
    grid.tone_index.push_back(static_cast<std::int16_t>(j - tones / 2));
  }
  return grid;
}

Expected<void> add_gradient(const ReceiverTracer& tracer,
                            const Transmitter& transmitter,
                            const OfdmGrid& grid,
                            const std::vector<NamedParameter>& named,
                            TraceReport& report) {
  std::vector<Parameter> parameters;
  parameters.reserve(named.size());
  for (const NamedParameter& each : named) {
    parameters.push_back(each.parameter);
  }
  const auto derivatives = tracer.differentiate(transmitter, report.paths, parameters);
  if (!derivatives) {
    return tl::make_unexpected(derivatives.error());
  }
  std::vector<std::complex<double>> adjoint = report.paths.cfr(grid);
  report.power = 0.0;
  for (std::complex<double>& h : adjoint) {
    *report.power += std::norm(h);
    h *= 2.0;
  }
  const std::vector<double> gradient = derivatives->loss_gradient(report.paths, grid, adjoint);
  for (std::size_t i = 0; i < named.size(); ++i) {
    report.gradient.emplace_back(named[i].name, gradient[i]);
  }
  return {};
}

Expected<TraceReport> trace(const TraceArguments& arguments,
                            const Link& link,
                            const OfdmGrid& grid,
                            const std::shared_ptr<const Scene>& scene) {
  std::vector<NamedParameter> parameters;
  if (!arguments.gradient.empty()) {
    auto parsed = parse_gradient(arguments.gradient, *scene);
    if (!parsed) {
      return tl::make_unexpected(parsed.error());
    }
    parameters = *std::move(parsed);
  }
  const ReceiverTracer tracer = PathTracer(scene, arguments.link.options).at(link.receiver);
  TraceReport report;
  report.paths = tracer.trace(link.transmitter);
  report.note = note_on_ends(*scene, link);
  if (report.paths.empty()) {
    report.note += (report.note.empty() ? "" : "; ") + std::string("no path");
  }
  if (arguments.link.options.diffuse) {
    if (auto scatters = check_scatters(*scene); !scatters) {
      return tl::make_unexpected(scatters.error());
    }
    report.diffuse = DiffuseTracer(scene, arguments.link.options, arguments.diffuse)
                         .density(link.transmitter, link.receiver);
  }
  if (!arguments.cfr.empty()) {
    report.cfr = report.paths.cfr(grid);
  }
  if (!parameters.empty()) {
    if (auto added = add_gradient(tracer, link.transmitter, grid, parameters, report); !added) {
      return tl::make_unexpected(added.error());
    }
  }
  return report;
}

Expected<void> run_trace(const TraceArguments& arguments) {
  const Expected<Link> link = parse_link(arguments.link);
  if (!link) {
    return tl::make_unexpected(link.error());
  }
  Expected<OfdmGrid> grid = OfdmGrid{};
  if (!arguments.cfr.empty()) {
    grid = parse_grid(arguments.cfr);
  }
  if (!grid) {
    return tl::make_unexpected(grid.error());
  }
  const auto source = load_scene_source(arguments.link.scene, arguments.link.frequency);
  if (!source) {
    return report_file_error(source.error());
  }
  if (!arguments.out.empty() && !is_npz(arguments.out)) {
    return make_error(ErrorKind::kUsage, "--out " + arguments.out + ": the name ends with .npz");
  }
  const Scene& scene = *source->scene;
  print_scene_notes(scene);
  if (arguments.cfr.empty()) {
    grid = OfdmGrid{scene.carrier_hz(), 0.0, {0}};  // for a gradient: the carrier alone
  }
  const auto report = trace(arguments, *link, *grid, source->scene);
  if (!report) {
    return tl::make_unexpected(report.error());
  }
  if (!report->note.empty()) {
    std::fprintf(stderr, "rayloc trace: %s\n", printable(report->note).c_str());
  }
  if (!arguments.out.empty()) {
    return write_npz(*report, *grid, scene, arguments.out);
  }
  std::fputs(
      (arguments.json ? trace_json(*report, scene) : printable(trace_table(*report, scene), '\n'))
          .c_str(),
      stdout);
  return {};
}

RunVerb declare_trace(OptionParser& app) {
  const auto arguments = std::make_shared<TraceArguments>();
  declare_link(app, arguments->link);
  app.get_option("--tx")->required();
  app.get_option("--rx")->required();
  declare_antennas(app, arguments->link);
  app.add_option("--cfr",
                 arguments->cfr,
                 "CENTRE,SPACING,COUNT [Hz]: also the frequency response h on these tones");
  app.add_option(
      "--gradient",
      arguments->gradient,
      "power:WHAT: also the derivatives of the sum of |h|^2 over the tones of --cfr (the "
      "carrier alone without it) by rx, tx, rx_orientation, tx_orientation, rx_gain, "
      "tx_gain, rx_array_turn, tx_array_turn, the name of an object (its translation), "
      "offset.OBJECT (each of its "
      "surfaces), eps_r.MATERIAL, sigma.MATERIAL, thickness.MATERIAL, scattering.MATERIAL (with "
      "--diffuse); several with "
      "commas; rx.0 is one axis of rx");
  ParserOption* const diffuse = app.add_flag("--diffuse",
                                             arguments->link.options.diffuse,
                                             "Rough materials (scattering_coefficient) reflect "
                                             "less; also what they scatter once, as power "
                                             "by delay. The scattering counts for the depth");
  app.add_option("--diffuse-reflections",
                 arguments->diffuse.reflections,
                 "Reflections before or after the scattering")
      ->check(in_range(0, 2))
      ->needs(diffuse)
      ->capture_default_str();
  app.add_option("--out",
                 arguments->out,
                 "FILE.npz: write arrays of numpy instead (a, tau, angles, interactions, objects, "
                 "vertices, object_names, and frequencies with cfr, gradient with gradient_names)");
  app.add_flag(
      "--json",
      arguments->json,
      "One JSON object, 17 significant digits: frequency, paths (kinds: a letter an "
      "interaction, R reflection, T transmission, D diffraction, S an edge passed with --soft), "
      "cfr, diffuse (power, mean_delay, delay_spread, and profile: the power in bins of step from "
      "first on [s]), power "
      "(the sum of |h|^2 that --gradient differentiates), gradient, note (what is remarkable "
      "about the link, as on stderr)");
  return [arguments] { return run_trace(*arguments); };
}

}  // namespace

extern const Verb kTrace;
const Verb kTrace = {
    "trace",
    "Trace the paths between two antennas of a scene",
    "rayloc trace tests/data/sites/meeting_room --tx 0.4,1.0,1.5 --rx -1.4,1.05,1.2\n"
    "  rayloc trace room.xml --tx 1,1,1 --rx 3,2,1.5 --transmission --cfr 5.19e9,312500,128 "
    "--gradient power:rx,eps_r.wood --json",
    declare_trace};

}  // namespace rayloc::cli
