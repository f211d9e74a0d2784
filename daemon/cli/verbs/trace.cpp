// `rayloc trace`: the paths between two antennas, their channel and its derivatives.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "daemon/base/arrays/npz_file.h"
#include "daemon/cli/arguments/gradient_argument.h"
#include "daemon/cli/arguments/grid_argument.h"
#include "daemon/cli/arguments/link_arguments.h"
#include "daemon/cli/arguments/scene_notes.h"
#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/trace/trace_arrays.h"
#include "daemon/lab/trace/trace_link.h"
#include "daemon/lab/trace/trace_report.h"
#include "daemon/site/scene/scene_source.h"
#include "engine/base/printable.h"

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

Expected<void> write_trace(const LinkTrace& traced,
                           const Scene& scene,
                           const TraceArguments& arguments) {
  if (!traced.note.empty()) {
    std::fprintf(stderr, "rayloc trace: %s\n", printable(traced.note).c_str());
  }
  if (!arguments.out.empty()) {
    return write_npz(traced, scene, arguments.out);
  }
  std::fputs(
      (arguments.json ? trace_json(traced, scene) : printable(trace_table(traced, scene), '\n'))
          .c_str(),
      stdout);
  return {};
}

Expected<void> run_trace(const TraceArguments& arguments) {
  const Expected<Link> link = parse_link(arguments.link);
  RAYLOC_TRY(link);
  LinkTraceOptions options{arguments.link.options, arguments.diffuse, {}, {}};
  if (!arguments.cfr.empty()) {
    auto tones = parse_grid(arguments.cfr);
    RAYLOC_TRY(tones);
    options.tones = *std::move(tones);
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
  if (!arguments.gradient.empty()) {
    auto parameters = parse_gradient(arguments.gradient, scene);
    RAYLOC_TRY(parameters);
    options.gradient = *std::move(parameters);
  }
  const auto traced = trace_link(source->scene, *link, options);
  return traced ? write_trace(*traced, scene, arguments) : tl::make_unexpected(traced.error());
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
