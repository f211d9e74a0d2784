// `rayloc evaluate`: how far estimates are from surveyed truth.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/verbs.h"
#include "daemon/draw/svg.h"
#include "daemon/evaluate/error_statistics.h"
#include "daemon/evaluate/estimates_file.h"
#include "daemon/evaluate/evaluate_fingerprints.h"
#include "daemon/evaluate/evaluate_report.h"
#include "daemon/evaluate/evaluation_plots.h"
#include "daemon/evaluate/truth.h"
#include "daemon/site/room_model.h"
#include "daemon/site/site.h"
#include "daemon/site/site_copy.h"
#include "daemon/survey/csv_table.h"

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

// What is compared with what.
struct Comparison {
  std::optional<Site> site;
  std::vector<TruthPoint> recorded;          // by the clock of the recordings
  std::vector<TruthPoint> truth;             // by the clock of the estimates
  std::vector<PublishedEstimate> estimates;  // those asked for
  std::vector<const LocationEstimate*> matches;
  std::vector<PointResult> results;
  Controls controls;
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

// Several devices answer for one truth: somebody should know. One person is as many targets as
// tracks.
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

Expected<Duration> time_offset(const std::string& text) {
  const auto offset = parse_decimal_seconds(text);
  constexpr auto kMostOffset = std::chrono::hours(24 * 365 * 100);
  if (!offset || *offset > kMostOffset || *offset < -kMostOffset) {
    return make_error(
        ErrorKind::kUsage,
        "--time-offset " + text + ": write seconds as a decimal number, at most a century");
  }
  return *offset;
}

// What belongs together, before anything is read.
Expected<void> check(const EvaluateArguments& arguments) {
  const std::size_t given = (arguments.fingerprints.empty() ? 0U : 1U) +
                            (arguments.points.empty() ? 0U : 1U) +
                            (arguments.captures.empty() ? 0U : 1U);
  if (given != 0 && (given != 3 || arguments.site.empty())) {
    return make_error(ErrorKind::kUsage,
                      "the control by fingerprints needs all of --fingerprints, --points (the "
                      "survey's recordings and csv), --capture (the recordings that the estimates "
                      "were made of) and --site");
  }
  return {};
}

Expected<Comparison> compare(const EvaluateArguments& arguments) {
  const auto offset = time_offset(arguments.time_offset);
  if (!offset) {
    return tl::make_unexpected(offset.error());
  }
  Comparison comparison;
  auto loaded = load_truth(arguments.truth);
  if (!loaded) {
    return tl::make_unexpected(loaded.error());
  }
  const auto estimates = load_estimates(arguments.estimates);
  if (!estimates) {
    return tl::make_unexpected(estimates.error());
  }
  comparison.recorded = *std::move(loaded);
  comparison.truth = shifted(comparison.recorded, *offset);
  comparison.estimates = select(*estimates, arguments);
  comparison.matches = match(comparison.truth, comparison.estimates);
  if (std::all_of(comparison.matches.begin(), comparison.matches.end(), [](const auto* m) {
        return m == nullptr;
      })) {
    return tl::make_unexpected(
        nothing_matches(*estimates, comparison.estimates, comparison.truth, arguments));
  }
  for (std::size_t i = 0; i < comparison.truth.size(); ++i) {
    comparison.results.push_back(evaluate_point(comparison.truth[i], comparison.matches[i]));
  }
  return comparison;
}

Expected<void> add_controls(const EvaluateArguments& arguments, Comparison& comparison) {
  if (arguments.site.empty()) {
    return {};
  }
  auto site = load_site(arguments.site);
  if (!site) {
    return tl::make_unexpected(std::move(site.error()));
  }
  comparison.site = *std::move(site);
  if (!comparison.site->has_bounds) {
    return make_error(ErrorKind::kConfiguration,
                      arguments.site +
                          ": the site states no [bounds], which the room-centre control "
                          "needs; add them to site.toml or leave --site out");
  }
  const Vec3d centre = 0.5 * (comparison.site->bounds_min + comparison.site->bounds_max);
  for (const TruthPoint& point : comparison.truth) {
    comparison.controls.room_centre.push_back(horizontal_distance(centre, point.position));
  }
  if (arguments.fingerprints.empty()) {
    return {};
  }
  const bool person = arguments.kind == "person";
  const FingerprintRequest request{arguments.fingerprints,
                                   arguments.points,
                                   arguments.captures,
                                   person,
                                   person ? "" : arguments.target};
  auto errors = fingerprint_errors(*comparison.site, request, comparison.recorded);
  if (!errors) {
    return tl::make_unexpected(std::move(errors.error()));
  }
  comparison.controls.fingerprint = *std::move(errors);
  return {};
}

Expected<draw::Drawing> error_map(const Comparison& comparison) {
  const auto room = load_room_model(*comparison.site);
  if (!room) {
    return tl::make_unexpected(room.error());
  }
  std::vector<draw::MapAntenna> antennas;
  for (const RoomAccessPoint& ap : room->access_points) {
    antennas.push_back({ap.id, ap.array.pose.position});
  }
  return draw_error_map(*room->scene, std::move(antennas), comparison.truth, comparison.matches);
}

std::vector<NamedErrors> error_curves(const Comparison& comparison) {
  std::vector<NamedErrors> curves(1);
  curves.front().name = "estimates";
  for (const PointResult& result : comparison.results) {
    curves.front().errors.push_back(result.error);
  }
  if (!comparison.controls.room_centre.empty()) {
    curves.push_back({"room centre", comparison.controls.room_centre});
  }
  if (!comparison.controls.fingerprint.empty()) {
    curves.push_back({"nearest fingerprint", comparison.controls.fingerprint});
  }
  return curves;
}

Expected<void> write_plots(const std::filesystem::path& directory, const Comparison& comparison) {
  std::map<std::string, draw::Drawing> plots;
  plots["cdf.svg"] = draw_error_distributions(error_curves(comparison));
  plots["coverage.svg"] = draw_coverage(comparison.results);
  plots["reliability.svg"] =
      draw_reliability(stated_outcomes(comparison.truth, comparison.matches));
  if (comparison.site) {
    auto map = error_map(comparison);
    if (!map) {
      return tl::make_unexpected(std::move(map.error()));
    }
    plots["map.svg"] = *std::move(map);
  } else {
    std::fputs("rayloc evaluate: no map of the room without --site\n", stderr);
  }
  for (const auto& [name, drawing] : plots) {
    if (auto written = write_file(directory / name, draw::to_svg(drawing)); !written) {
      return written;
    }
  }
  return {};
}

Expected<void> run_evaluate(const EvaluateArguments& arguments) {
  if (auto checked = check(arguments); !checked) {
    return checked;
  }
  auto comparison = compare(arguments);
  if (!comparison) {
    return tl::make_unexpected(std::move(comparison.error()));
  }
  if (arguments.kind == "device") {
    warn_of_several_targets(comparison->estimates);
  }
  if (auto added = add_controls(arguments, *comparison); !added) {
    return added;
  }
  if (!arguments.plot.empty()) {
    if (auto prepared = prepare_output(arguments.plot, arguments.force); !prepared) {
      return prepared;
    }
    if (auto written = write_plots(arguments.plot, *comparison); !written) {
      return written;
    }
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
  app.add_option("--kind", arguments->kind, "What is located")
      ->check(one_of({"device", "person"}))
      ->capture_default_str();
  app.add_option("--estimate", arguments->estimate, "Which estimates of it")
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
