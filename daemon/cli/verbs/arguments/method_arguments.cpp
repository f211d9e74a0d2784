#include "daemon/cli/verbs/arguments/method_arguments.h"

#include <charconv>
#include <cmath>
#include <system_error>

#include "daemon/methods/track_options.h"
#include "engine/base/vec3.h"
#include "engine/baselines/settings.h"
#include "engine/paper/settings.h"

namespace rayloc::cli {
namespace {

std::string help_of_baselines() {
  std::string help = "KEY=VALUE: settings of the methods that others published, with defaults:";
  for (const Method* method : methods()) {
    if (!method->baseline_settings.empty()) {
      help += "\n" + std::string(method->name) + ":\n" +
              baseline_settings_help(method->baseline_settings);
      help.pop_back();  // line break at the end
    }
  }
  return help;
}

std::vector<std::string> names_of_likelihoods() {
  std::vector<std::string> names;
  for (const LikelihoodName& one : likelihood_names()) {
    names.emplace_back(one.name);
  }
  return names;
}

std::vector<std::string> names_of_methods() {
  return {method_names().begin(), method_names().end()};
}

std::string help_of_likelihoods() {
  std::string help = "quantity that method rayloc compares:";
  for (const LikelihoodName& one : likelihood_names()) {
    help += "\n" + std::string(one.name) + ": " + std::string(one.description);
  }
  return help;
}

// "X,Y" [m].
Expected<Vec3d> read_start(const std::string& text, const Method& method) {
  if (!method.takes_start) {
    return make_error(ErrorKind::kUsage,
                      "--start: method " + std::string(method.name) + " takes no start");
  }
  Vec3d start;
  const char* const end = text.data() + text.size();
  const auto x = std::from_chars(text.data(), end, start.x);
  const bool has_comma = x.ec == std::errc() && x.ptr != end && *x.ptr == ',';
  const auto y = has_comma ? std::from_chars(x.ptr + 1, end, start.y) : x;
  if (!has_comma || y.ec != std::errc() || y.ptr != end || !std::isfinite(start.x) ||
      !std::isfinite(start.y)) {
    return make_error(ErrorKind::kUsage,
                      "--start " + text + ": write X,Y in metres, for example --start 0.3,-1.2");
  }
  return start;
}

// The reason why --tracks is refused; empty if it is not.
std::string fault_of_tracks(const MethodArguments& options, const Method& method) {
  if (options.tracks.empty()) {
    return {};
  }
  if (!method.has_setting(kTracksSetting)) {
    return "--tracks: method " + options.name + " has no grid and no cloud; leave --tracks out";
  }
  if (options.exhaustive) {
    return "--tracks: --exhaustive follows devices by the grid of the whole room; leave one of the "
           "two out";
  }
  return {};
}

}  // namespace

Expected<MethodOptions> method_options(const MethodArguments& options) {
  const Method& method = *find_method(options.name);
  MethodOptions settings;
  settings.seed = options.seed;
  settings.is_exhaustive = options.exhaustive;
  if (!options.start.empty()) {
    auto start = read_start(options.start, method);
    RAYLOC_TRY(start);
    settings.start = *start;
  }
  if (options.starts > 1 || !options.paper.empty()) {
    if (!method.has_setting("multi_start")) {
      const std::string option = options.paper.empty() ? "--multi-start" : "--paper";
      return make_error(
          ErrorKind::kUsage,
          option + " is of method paper, not of " + options.name + "; use --method paper");
    }
    settings.values.insert_or_assign("multi_start", static_cast<double>(options.starts));
  }
  for (const std::string& text : options.paper) {
    const auto assignment = paper::read_assignment(text);
    if (!assignment) {
      return make_error(ErrorKind::kUsage, "--paper " + assignment.error().message);
    }
    settings.values.insert_or_assign(std::string(assignment->setting->key), assignment->value);
  }
  for (const std::string& text : options.baseline) {
    if (method.baseline_settings.empty()) {
      return make_error(ErrorKind::kUsage,
                        "--baseline: method " + options.name + " has no such settings");
    }
    if (auto read =
            read_baseline_value(text, method.name, method.baseline_settings, settings.values);
        !read) {
      return make_error(ErrorKind::kUsage, "--baseline " + read.error().message);
    }
  }
  if (options.likelihood != likelihood_names().front().name) {
    if (!method.has_setting("likelihood")) {
      return make_error(ErrorKind::kUsage,
                        "--likelihood: method " + options.name +
                            " has a loss of its own; leave --likelihood out");
    }
    settings.values.insert_or_assign("likelihood", options.likelihood);
  }
  if (const std::string fault = fault_of_tracks(options, method); !fault.empty()) {
    return make_error(ErrorKind::kUsage, fault);
  }
  if (!options.tracks.empty()) {
    settings.values.insert_or_assign(std::string(kTracksSetting), options.tracks);
  }
  return settings;
}

void add_method_options(OptionParser& app, MethodArguments& options) {
  app.add_option("--method", options.name, methods_help())
      ->check(one_of(names_of_methods()))
      ->capture_default_str();
  app.add_option("--likelihood", options.likelihood, help_of_likelihoods())
      ->check(one_of(names_of_likelihoods()))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "seed of random numbers; rayloc draws none")
      ->capture_default_str();
  app.add_option("--multi-start", options.starts, "random starts of paper; the least loss wins")
      ->check(in_range(1, 10'000))
      ->capture_default_str();
  app.add_option(
      "--paper",
      options.paper,
      "KEY=VALUE: hyper-parameters and ablations of method paper, with their defaults for devices "
      "(for people where they differ):\n" +
          paper::settings_help());
  app.add_option("--baseline", options.baseline, help_of_baselines());
  app.add_option("--start",
                 options.start,
                 "X,Y [m] where the first descent of paper begins, instead of a random place");
  app.add_flag("--exhaustive",
               options.exhaustive,
               "compare every burst of a track with the whole room; else with where it may be");
  app.add_option("--tracks",
                 options.tracks,
                 "how method rayloc follows a device once its track is confirmed: by the grid of "
                 "the room, or by a cloud of places; default: " +
                     std::string(kTracksValues.front()))
      ->check(one_of({kTracksValues.begin(), kTracksValues.end()}));
}

}  // namespace rayloc::cli
