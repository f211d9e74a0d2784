// `rayloc survey`: makes the points file of a calibration while the access points receive live.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "capture/source/transport_schemes.h"
#include "daemon/cli/arguments/scene_notes.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/arguments/survey_ports.h"
#include "daemon/cli/verbs/survey_dialogue.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/survey/survey_session.h"

namespace rayloc::cli {
namespace {

struct SurveyVerbArguments {
  SurveyPortArguments ports;
  std::string out;
  std::string plan;
  std::size_t frames = 20;
  double timeout = 30.0;  // [s]
};

Expected<void> run_survey(const SurveyVerbArguments& arguments) {
  const auto site = load_site(arguments.ports.site);
  RAYLOC_TRY(site);
  auto room = load_room_model(*site);
  RAYLOC_TRY(room);
  print_scene_notes(*room->scene);
  const auto ports = survey_ports(arguments.ports, *site);
  RAYLOC_TRY(ports);
  std::vector<PlannedPoint> plan;
  if (!arguments.plan.empty()) {
    auto planned = load_planned_points(arguments.plan);
    RAYLOC_TRY(planned);
    plan = *std::move(planned);
  }
  auto file = SurveyFile::open(arguments.out);
  RAYLOC_TRY(file);
  auto listener = SurveyListener::open(*site, *ports);
  RAYLOC_TRY(listener);
  StopSignal::install();
  SurveySession session(*std::move(room), *std::move(listener), *std::move(file), std::move(plan));
  auto done = SurveyDialogue(session, {arguments.frames, from_seconds(arguments.timeout)}).run();
  const nlohmann::ordered_json summary = {
      {"summary", {{"points", session.points_written()}, {"file", arguments.out}}}};
  std::printf("%s\n", summary.dump().c_str());
  return done;
}

RunVerb declare_survey(OptionParser& app) {
  const auto arguments = std::make_shared<SurveyVerbArguments>();
  app.add_option("SITE", arguments->ports.site, "Directory with site.toml")->required();
  app.add_option("--out",
                 arguments->out,
                 "The points file; one that exists is continued, with recordings of its own")
      ->required();
  app.add_option("--listen",
                 arguments->ports.listen,
                 "Where access points send to: [AP=]HOST:PORT, or [AP=] and " +
                     transport_syntax(transport_schemes(), TransportUse::kLiveSource));
  app.add_option(
      "--config", arguments->ports.config, "Take the live sources of raylocd's configuration");
  app.add_option("--site",
                 arguments->ports.name,
                 "With several sites there, the name of one; default: the site of this directory");
  app.add_option("--record", arguments->ports.record, "Also record what arrives: [AP=]FILE.pcap");
  app.add_option("--plan",
                 arguments->plan,
                 "Planned points, x,y,z,name (rayloc calibrate --plan): Enter takes the next one");
  app.add_option("--frames", arguments->frames, "Frames of every access point at each point")
      ->check(in_range(1, 100'000))
      ->capture_default_str();
  app.add_option("--timeout", arguments->timeout, "A point ends after so many seconds in any case")
      ->check(positive())
      ->capture_default_str();
  return [arguments] { return run_survey(*arguments); };
}

}  // namespace

extern const Verb kSurvey;
const Verb kSurvey = {
    "survey",
    "Survey a site: go to a point, press Enter, frames are counted, next",
    "rayloc survey office --out points.csv --listen ap1=0.0.0.0:5501 ap2=0.0.0.0:5502 "
    "--record ap1=a.pcap ap2=b.pcap\n"
    "  rayloc survey office --out points.csv --config raylocd.toml --plan plan.csv\n\n"
    "While frames are counted, Enter ends the point with what there is. A row is written after\n"
    "each point at once. Then: rayloc calibrate office --points points.csv --capture ap1=a.pcap "
    "...\n"
    "A survey that is continued needs new names for --record; calibrate takes all of them: "
    "--capture ap1=a.pcap ap1=a2.pcap ...",
    declare_survey};

}  // namespace rayloc::cli
