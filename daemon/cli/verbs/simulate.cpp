// `rayloc simulate`: simulates recordings of a site's access points for a device at given points.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/arguments/simulate_arguments.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/simulate/simulate_recordings.h"
#include "daemon/lab/simulate/simulate_report.h"
#include "daemon/site/model/site.h"

namespace rayloc::cli {
namespace {

SimulationObserver standard_error() {
  SimulationObserver observer;
  observer.on_note = [](const std::string& note) {
    std::fprintf(stderr, "rayloc simulate: %s\n", note.c_str());
  };
  observer.on_scene_note = [](const SceneNote& note) {
    std::fprintf(stderr, "%s\n", to_line(note).c_str());
  };
  return observer;
}

Expected<void> run_simulate(const SimulateArguments& arguments) {
  const auto site = load_site(arguments.site);
  RAYLOC_TRY(site);
  auto outputs = resolve_captures(arguments.out, access_point_ids(*site));
  RAYLOC_TRY(outputs);
  SimulationOptions options = arguments.simulation;
  for (const CaptureArgument& output : *outputs) {
    options.outputs.push_back({output.access_point, output.file});
  }
  const auto truth = simulate_recordings(
      *site, options, arguments.quiet ? SimulationObserver() : standard_error());
  RAYLOC_TRY(truth);
  std::fputs(simulation_json(*truth).c_str(), stdout);
  return {};
}

RunVerb declare_simulate(OptionParser& app) {
  const auto arguments = std::make_shared<SimulateArguments>();
  add_simulate_options(app, *arguments);
  return [arguments] { return run_simulate(*arguments); };
}

}  // namespace

extern const Verb kSimulate;
const Verb kSimulate = {
    "simulate",
    "Simulate the recordings of a site's access points, with the ray tracer",
    "rayloc simulate office --points survey.csv --out ap1=a.pcap ap2=b.pcap\n"
    "  rayloc simulate office --points people.csv --person --transmitter plug --out "
    "ap1=people.pcap\n"
    "  rayloc simulate office --points survey.csv --out a.pcap --impairments none --frames 1\n"
    "  rayloc simulate CALIBRATED --points spots.csv --out a.pcap --model-error\n"
    "  rayloc simulate CALIBRATED --points spots.csv --out hops.pcap --channels 36-64\n"
    "  rayloc simulate office --points walk.csv --out ap1=day2.pcap --second-day default "
    "--height-sigma 0.3 --tilt-deg 35 --power-sigma-db 4 --truth truth.csv\n\n"
    "For tests, planning and studies. The simulation uses the propagation model of the "
    "localization; the recordings do not predict the accuracy in a real room.\n"
    "Prints the simulated parameters as JSON, with the phases and gains of the chains. Recordings "
    "with the same seed have the same chains; with --second-day, those of that day.",
    declare_simulate};

}  // namespace rayloc::cli
