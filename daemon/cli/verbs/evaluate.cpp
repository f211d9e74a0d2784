// `rayloc evaluate`: errors of estimates against surveyed truth.
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/evaluate/comparison.h"
#include "daemon/lab/evaluate/comparison_plots.h"
#include "daemon/lab/evaluate/error_statistics.h"
#include "daemon/lab/evaluate/evaluate_report.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/survey/time_offset.h"

namespace rayloc::cli {
namespace {

struct EvaluateArguments {
  std::string estimates;
  std::string truth;
  std::string kind = "device";
  std::string estimate = "snapshot";
  std::string target;
  std::string time_offset = "0";
  std::string site;
  std::vector<std::string> fingerprints;
  std::string points;
  std::vector<std::string> captures;
  std::string plot;
  bool json = false;
  bool force = false;
};

// Warns that several devices are compared with one truth. A person is as many targets as tracks.
void warn_of_several_targets(const std::vector<PublishedEstimate>& estimates) {
  std::set<std::string> targets;
  for (const PublishedEstimate& estimate : estimates) {
    targets.insert(estimate.target);
  }
  if (targets.size() > 1) {
    std::fprintf(stderr,
                 "rayloc evaluate: the estimates are of %zu targets; choose one with --target %s\n",
                 targets.size(),
                 targets.begin()->c_str());
  }
}

Expected<void> write_plots(const EvaluateArguments& arguments, const Comparison& comparison) {
  RAYLOC_TRY(prepare_output(arguments.plot, arguments.force));
  if (!comparison.site) {
    std::fputs("rayloc evaluate: no map of the room without --site\n", stderr);
  }
  return write_comparison_plots(arguments.plot, comparison);
}

Expected<void> run_evaluate(const EvaluateArguments& arguments) {
  const auto offset = parse_time_offset(arguments.time_offset);
  RAYLOC_TRY(offset);
  const Observer observer{{}, [](const std::string& note) {
                            std::fprintf(stderr, "rayloc evaluate: %s\n", note.c_str());
                          }};
  const auto comparison = compare_with_truth({arguments.estimates,
                                              arguments.truth,
                                              arguments.kind == "person",
                                              arguments.estimate == "filtered",
                                              arguments.target,
                                              *offset,
                                              arguments.site,
                                              arguments.fingerprints,
                                              arguments.points,
                                              arguments.captures},
                                             observer);
  RAYLOC_TRY(comparison);
  if (arguments.kind == "device") {
    warn_of_several_targets(comparison->estimates);
  }
  if (!arguments.plot.empty()) {
    RAYLOC_TRY(write_plots(arguments, *comparison));
  }
  const ErrorStatistics statistics =
      compute_statistics(comparison->results, comparison->controls, {});
  const std::string report =
      arguments.json ? statistics_json(statistics) : statistics_table(statistics);
  std::fputs(report.c_str(), stdout);
  return {};
}

RunVerb declare_evaluate(OptionParser& app) {
  auto arguments = std::make_shared<EvaluateArguments>();
  app.add_option("--estimates",
                 arguments->estimates,
                 "Locations or Envelopes: jsonl or pb; - is standard input")
      ->required();
  app.add_option(
         "--truth", arguments->truth, "csv: t_start,t_end,x,y,z per spot or t,x,y,z per instant")
      ->required();
  app.add_option("--kind", arguments->kind, "Kind of target")
      ->check(one_of({"device", "person"}))
      ->capture_default_str();
  app.add_option("--estimate", arguments->estimate, "Kind of its estimates")
      ->check(one_of({"snapshot", "filtered"}))
      ->capture_default_str();
  app.add_option("--target", arguments->target, "Only this target: its address, or person-N");
  app.add_option("--time-offset", arguments->time_offset, "Seconds added to the times of the truth")
      ->capture_default_str();
  app.add_option("--site",
                 arguments->site,
                 "For the control (the error of always answering the room's centre) and the map");
  app.add_option("--fingerprints",
                 arguments->fingerprints,
                 "[AP=]FILE: recordings of a survey, for the control of answering the most similar "
                 "surveyed point; with --points, --capture and --site");
  app.add_option("--points", arguments->points, "csv of that survey: t_start,t_end,x,y,z");
  app.add_option("--capture",
                 arguments->captures,
                 "[AP=]FILE: the recordings that the estimates were made of");
  app.add_option("--plot",
                 arguments->plot,
                 "Directory for cdf.svg, map.svg (with --site), coverage.svg, reliability.svg");
  app.add_flag("--force", arguments->force, "Write into a directory that is not empty");
  app.add_flag(
      "--json",
      arguments->json,
      "One JSON object; a figure that misses made infinite, or that nothing states, is null");
  return [arguments] { return run_evaluate(*arguments); };
}

}  // namespace

extern const Verb kEvaluate{"evaluate",
                            "Compare estimates with surveyed truth",
                            "rayloc evaluate --estimates fixes.jsonl --truth spots.csv --site "
                            "tests/data/sites/meeting_room\n"
                            "  rayloc evaluate --estimates fixes.jsonl --truth spots.csv --site "
                            "room --fingerprints survey.pcap --points survey.csv --capture "
                            "spots.pcap --plot plots",
                            declare_evaluate};

}  // namespace rayloc::cli
