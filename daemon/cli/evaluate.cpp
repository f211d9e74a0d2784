// `rayloc evaluate`: how far estimates are from surveyed truth.
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/cli/evaluate_report.h"
#include "daemon/cli/verbs.h"
#include "daemon/evaluate/error_statistics.h"
#include "daemon/evaluate/estimates_file.h"
#include "daemon/evaluate/truth.h"
#include "daemon/site/csv_table.h"
#include "daemon/site/site.h"

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
  bool json = false;
};

// The estimates that are asked for.
std::vector<PublishedEstimate> select(const std::vector<PublishedEstimate>& estimates,
                                      const EvaluateArguments& arguments) {
  std::vector<PublishedEstimate> selected;
  std::copy_if(estimates.begin(),
               estimates.end(),
               std::back_inserter(selected),
               [&](const PublishedEstimate& e) {
                 return e.person == (arguments.kind == "person") &&
                        e.filtered == (arguments.estimate == "filtered") &&
                        (arguments.target.empty() || e.target == arguments.target);
               });
  return selected;
}

// Several targets answer for one truth: a person should know.
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

std::string iso_time(Timestamp time) {
  const auto seconds = std::chrono::floor<std::chrono::milliseconds>(time).time_since_epoch();
  return std::to_string(seconds.count() / 1000) + "." +
         std::to_string(1000 + seconds.count() % 1000).substr(1);
}

// Why no estimate answers for any point, with what to do.
Error nothing_matches(const std::vector<PublishedEstimate>& estimates,
                      const std::vector<PublishedEstimate>& selected,
                      const std::vector<TruthPoint>& truth,
                      const EvaluateArguments& arguments) {
  std::string message = arguments.estimates + ": ";
  if (selected.empty()) {
    message += "none of " + std::to_string(estimates.size()) + " estimates is a " +
               arguments.estimate + (arguments.estimate == "filtered" ? " estimate" : "") +
               " of a " + arguments.kind + "; see --estimate, --kind and --target";
    return {ErrorKind::kBadInput, message};
  }
  const auto by_time = [](const PublishedEstimate& a, const PublishedEstimate& b) {
    return a.estimate.time < b.estimate.time;
  };
  const auto [first, last] = std::minmax_element(selected.begin(), selected.end(), by_time);
  message += "no estimate lies in the times of the truth: estimates from " +
             iso_time(first->estimate.time) + " to " + iso_time(last->estimate.time) +
             ", truth from " + iso_time(truth.front().begin) + " to " + iso_time(truth.back().end) +
             "; --time-offset is added to the truth (rayloc send prints it)";
  return {ErrorKind::kBadInput, message};
}

Expected<std::optional<Vec3d>> room_centre(const std::string& directory) {
  if (directory.empty()) {
    return std::nullopt;
  }
  const auto site = load_site(directory);
  if (!site) {
    return tl::make_unexpected(site.error());
  }
  if (!site->has_bounds) {
    return make_error(ErrorKind::kConfiguration,
                      directory +
                          ": the site states no [bounds], which the room-centre control "
                          "needs; add them to site.toml or leave --site out");
  }
  return 0.5 * (site->bounds_min + site->bounds_max);
}

Expected<void> run_evaluate(const EvaluateArguments& arguments) {
  const auto offset = parse_decimal_seconds(arguments.time_offset);
  constexpr auto kMostOffset = std::chrono::hours(24 * 365 * 100);
  if (!offset || *offset > kMostOffset || *offset < -kMostOffset) {
    return make_error(ErrorKind::kUsage,
                      "--time-offset " + arguments.time_offset +
                          ": write seconds as a decimal number, at most a century");
  }
  const auto loaded = load_truth(arguments.truth);
  if (!loaded) {
    return tl::make_unexpected(loaded.error());
  }
  const auto estimates = load_estimates(arguments.estimates);
  if (!estimates) {
    return tl::make_unexpected(estimates.error());
  }
  const auto centre = room_centre(arguments.site);
  if (!centre) {
    return tl::make_unexpected(centre.error());
  }
  const std::vector<TruthPoint> truth = shifted(*loaded, *offset);
  const std::vector<PublishedEstimate> selected = select(*estimates, arguments);
  const auto matches = match(truth, selected);
  if (std::all_of(matches.begin(), matches.end(), [](const auto* m) { return m == nullptr; })) {
    return tl::make_unexpected(nothing_matches(*estimates, selected, truth, arguments));
  }
  warn_of_several_targets(selected);
  StatisticsOptions options;
  options.room_centre = *centre;
  const ErrorStatistics statistics = compute_statistics(truth, matches, options);
  const std::string report =
      arguments.json ? statistics_json(statistics) : statistics_table(statistics);
  std::fputs(report.c_str(), stdout);
  return {};
}

RunVerb declare_evaluate(CLI::App& app) {
  auto arguments = std::make_shared<EvaluateArguments>();
  app.add_option("--estimates",
                 arguments->estimates,
                 "Locations or Envelopes: jsonl or pb; - is standard input")
      ->required();
  app.add_option(
         "--truth", arguments->truth, "csv: t_start,t_end,x,y,z per spot or t,x,y,z per instant")
      ->required();
  app.add_option("--kind", arguments->kind, "What is located")
      ->check(CLI::IsMember({"device", "person"}))
      ->capture_default_str();
  app.add_option("--estimate", arguments->estimate, "Which estimates of it")
      ->check(CLI::IsMember({"snapshot", "filtered"}))
      ->capture_default_str();
  app.add_option("--target", arguments->target, "Only this target: its address, or person-N");
  app.add_option("--time-offset", arguments->time_offset, "Seconds added to the times of the truth")
      ->capture_default_str();
  app.add_option("--site",
                 arguments->site,
                 "For the control: the error of always answering the room's centre");
  app.add_flag(
      "--json", arguments->json, "One JSON object; a figure that misses made infinite is null");
  return [arguments] { return run_evaluate(*arguments); };
}

}  // namespace

extern const Verb kEvaluate{"evaluate",
                            "Compare estimates with surveyed truth",
                            "rayloc evaluate --estimates fixes.jsonl --truth spots.csv --site "
                            "tests/data/sites/meeting_room",
                            declare_evaluate};

}  // namespace rayloc::cli
