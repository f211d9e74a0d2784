// `rayloc survey`: makes the points file of a calibration while the access points receive live.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "capture/source/transport_schemes.h"
#include "daemon/cli/arguments/scene_notes.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/line_input.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/live/config/config.h"
#include "daemon/live/config/source_url.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/scene/solid_around.h"
#include "daemon/site/survey/survey_answer.h"
#include "daemon/site/survey/survey_file.h"
#include "daemon/site/survey/survey_listener.h"
#include "engine/base/printable.h"
#include "engine/base/suggestion.h"

namespace rayloc::cli {
namespace {

constexpr Duration kListenTick = std::chrono::milliseconds(20);
constexpr double kSamePlace = 0.01;  // [m]: a planned point this close to a row is done

struct SurveyVerbArguments {
  std::string site;
  std::string out;
  std::string plan;
  std::string config;
  std::string name;  // one of several sites in `config`
  std::vector<std::string> listen;
  std::vector<std::string> record;
  std::size_t frames = 20;
  double timeout = 30.0;  // [s]
};

Timestamp now() { return std::chrono::system_clock::now(); }

// Selects the surveyed site of a raylocd: the only site, the named one, or else the one of that
// directory or, if the survey uses another copy of it, of that name.
Expected<SiteSetup> configured_site(const SurveyVerbArguments& arguments, const Site& site) {
  auto setup = load_daemon_setup(arguments.config);
  if (!setup) {
    return tl::make_unexpected(setup.error());
  }
  std::vector<std::function<bool(const SiteSetup&)>> criteria;
  if (arguments.name.empty()) {
    criteria = {[&](const SiteSetup&) { return setup->sites.size() == 1; },
                [&](const SiteSetup& one) {
                  std::error_code ignored;
                  return std::filesystem::equivalent(one.directory, arguments.site, ignored);
                },
                [&](const SiteSetup& one) { return one.site.name == site.name; }};
  } else {
    criteria = {[&](const SiteSetup& one) { return one.site.name == arguments.name; }};
  }
  for (const auto& is_meant : criteria) {
    const auto found = std::find_if(setup->sites.begin(), setup->sites.end(), is_meant);
    if (found != setup->sites.end() &&
        std::none_of(std::next(found), setup->sites.end(), is_meant)) {
      return std::move(*found);
    }
  }
  std::vector<std::string_view> names;
  names.reserve(setup->sites.size());
  for (const SiteSetup& one : setup->sites) {
    names.emplace_back(one.site.name);
  }
  return make_error(
      ErrorKind::kUsage,
      arguments.config +
          ": which of its sites is surveyed? Write --site with one of: " + list_of(names));
}

// Live sources of a site in raylocd's configuration, in the syntax of --listen.
Expected<std::vector<std::string>> configured_ports(const SurveyVerbArguments& arguments,
                                                    const Site& site) {
  const auto setup = configured_site(arguments, site);
  if (!setup) {
    return tl::make_unexpected(setup.error());
  }
  std::vector<std::string> listen;
  for (const SourceConfig& source : setup->config.sources) {
    if (!is_live(source)) {
      return make_error(
          ErrorKind::kUsage,
          source.place + "no live source; write --listen AP=HOST:PORT instead of --config");
    }
    listen.push_back(source.access_point + "=" + source_url(source));
  }
  return listen;
}

Expected<std::vector<SurveyPort>> ports_of(const SurveyVerbArguments& arguments, const Site& site) {
  if (arguments.listen.empty() == arguments.config.empty()) {
    return make_error(ErrorKind::kUsage,
                      "state the addresses to which the access points send: --listen "
                      "[AP=]HOST:PORT, or --config raylocd.toml (one of the two)");
  }
  auto listen = arguments.config.empty() ? Expected<std::vector<std::string>>(arguments.listen)
                                         : configured_ports(arguments, site);
  if (!listen) {
    return tl::make_unexpected(std::move(listen.error()));
  }
  const auto addresses = resolve_captures(*listen, access_point_ids(site));
  const auto recordings = resolve_captures(arguments.record, access_point_ids(site));
  for (const auto* resolved : {&addresses, &recordings}) {
    if (!*resolved) {
      return tl::make_unexpected(resolved->error());
    }
  }
  std::vector<SurveyPort> ports;
  for (const CaptureArgument& address : *addresses) {
    const auto index = find_access_point(site, address.access_point);
    SurveyPort port{static_cast<std::size_t>(index.value_or(0)), address.file, ""};
    for (const CaptureArgument& recording : *recordings) {
      if (recording.access_point == address.access_point) {
        port.recording = recording.file;
      }
    }
    ports.push_back(std::move(port));
  }
  return ports;
}

class Survey {
 public:
  Survey(const SurveyVerbArguments& arguments,
         RoomModel room,
         SurveyListener listener,
         SurveyFile file)
      : arguments_(arguments),
        room_(std::move(room)),
        listener_(std::move(listener)),
        file_(std::move(file)) {}

  void plan(std::vector<PlannedPoint> points) { plan_ = std::move(points); }

  // Surveys points until the person ends it, the input ends, or a signal arrives.
  Expected<void> run() {
    while (true) {
      const auto point = ask();
      if (!point) {
        return tl::make_unexpected(point.error());
      }
      if (!*point) {
        return listener_.finish();
      }
      if (auto measured = measure(**point); !measured) {
        return measured;
      }
    }
  }

  std::size_t points_written() const { return written_; }

 private:
  const PlannedPoint* next_planned() const {
    for (const PlannedPoint& planned : plan_) {
      const bool done =
          std::any_of(file_.points().begin(), file_.points().end(), [&](const SurveyPoint& point) {
            return norm(point.position - planned.position) < kSamePlace;
          });
      if (!done) {
        return &planned;
      }
    }
    return nullptr;
  }

  static std::string text_of(const PlannedPoint& point) {
    return fmt::format("{}{:.3f},{:.3f},{:.3f}",
                       point.name.empty() ? "" : point.name + " at ",
                       point.position.x,
                       point.position.y,
                       point.position.z);
  }

  // Returns the objection to a point; empty if the point can be surveyed.
  std::string objection(const Vec3d& p) const {
    const Vec3d& lower = room_.bounds_min;
    const Vec3d& upper = room_.bounds_max;
    if (p.x < lower.x || p.y < lower.y || p.z < lower.z || p.x > upper.x || p.y > upper.y ||
        p.z > upper.z) {
      return fmt::format(
          "outside of the room: x {:.2f} to {:.2f}, y {:.2f} to {:.2f}, z {:.2f} to {:.2f}",
          lower.x,
          upper.x,
          lower.y,
          upper.y,
          lower.z,
          upper.z);
    }
    const auto solid = solid_around(*room_.scene, p);
    return solid ? "inside of object '" + printable(room_.scene->objects()[*solid].name) + "'" : "";
  }

  // Returns empty when the survey is over.
  Expected<std::optional<PlannedPoint>> ask() {
    const PlannedPoint* next = next_planned();
    std::fprintf(stderr,
                 "next point (%sx,y,z%s, q to end): ",
                 next != nullptr ? ("Enter for " + text_of(*next) + ", or ").c_str() : "",
                 plan_.empty() ? "" : " or name of a planned point");
    while (true) {
      while (input_.front() == nullptr) {
        if (StopSignal::requested() || input_.ended()) {
          std::fputs("\n", stderr);
          return std::nullopt;
        }
        if (auto received = listener_.listen(kListenTick); !received) {
          return tl::make_unexpected(received.error());
        }
        input_.poll();
      }
      const auto answer = parse_survey_answer(*input_.front(), plan_, next, room_.device.height);
      input_.pop();
      const std::string wrong = !answer        ? answer.error().message
                                : answer->quit ? ""
                                               : objection(answer->point.position);
      if (wrong.empty()) {
        return answer->quit ? std::nullopt : std::optional(answer->point);
      }
      std::fprintf(stderr, "%s\nnext point: ", wrong.c_str());
    }
  }

  // An empty line ends a point early; other lines are answers to the next prompt.
  bool is_ended_early() {
    input_.poll();
    const bool empty = input_.front() != nullptr && input_.front()->empty();
    if (empty) {
      input_.pop();
    }
    return empty;
  }

  Expected<void> measure(const PlannedPoint& point) {
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const Timestamp start = now();
    const auto deadline = std::chrono::steady_clock::now() + from_seconds(arguments_.timeout);
    listener_.start_counting(start);
    std::vector<std::size_t> counts;
    do {
      if (auto received = listener_.listen(kListenTick); !received) {
        return received;
      }
      counts = listener_.counts();
      if (terminal) {
        std::fprintf(stderr, "\r%s  ", counts_text(counts).c_str());
      }
      if (StopSignal::requested()) {
        std::fprintf(stderr, "\n%s: interrupted, not written\n", text_of(point).c_str());
        return {};
      }
    } while (*std::min_element(counts.begin(), counts.end()) < arguments_.frames &&
             !is_ended_early() && std::chrono::steady_clock::now() < deadline);
    std::fprintf(stderr,
                 "%s%s: %s\n",
                 terminal ? "\r" : "",
                 text_of(point).c_str(),
                 counts_text(counts).c_str());
    warn_of_silence(counts);
    if (*std::max_element(counts.begin(), counts.end()) == 0) {
      std::fputs("no frame was received: the point is not written\n", stderr);
      return {};
    }
    ++written_;
    return file_.append({start, now(), point.position, 0});
  }

  std::string counts_text(const std::vector<std::size_t>& counts) const {
    std::string text;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      text += fmt::format("{}{} {}/{}",
                          i == 0 ? "" : "  ",
                          listener_.access_point(i),
                          counts[i],
                          arguments_.frames);
    }
    return text;
  }

  void warn_of_silence(const std::vector<std::size_t>& counts) const {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (counts[i] == 0) {
        std::fprintf(stderr,
                     "warning: %s received no whole frame of the device\n",
                     listener_.access_point(i).c_str());
      }
    }
  }

  const SurveyVerbArguments& arguments_;
  RoomModel room_;
  SurveyListener listener_;
  SurveyFile file_;
  std::vector<PlannedPoint> plan_;
  LineInput input_{STDIN_FILENO};
  std::size_t written_ = 0;
};

Expected<void> run_survey(const SurveyVerbArguments& arguments) {
  const auto site = load_site(arguments.site);
  if (!site) {
    return tl::make_unexpected(site.error());
  }
  auto room = load_room_model(*site);
  if (!room) {
    return tl::make_unexpected(std::move(room.error()));
  }
  print_scene_notes(*room->scene);
  const auto ports = ports_of(arguments, *site);
  if (!ports) {
    return tl::make_unexpected(ports.error());
  }
  std::vector<PlannedPoint> plan;
  if (!arguments.plan.empty()) {
    auto planned = load_planned_points(arguments.plan);
    if (!planned) {
      return tl::make_unexpected(std::move(planned.error()));
    }
    plan = *std::move(planned);
  }
  auto file = SurveyFile::open(arguments.out);
  if (!file) {
    return tl::make_unexpected(std::move(file.error()));
  }
  auto listener = SurveyListener::open(*site, *ports);
  if (!listener) {
    return tl::make_unexpected(std::move(listener.error()));
  }
  StopSignal::install();
  Survey survey(arguments, *std::move(room), *std::move(listener), *std::move(file));
  survey.plan(std::move(plan));
  auto done = survey.run();
  const nlohmann::ordered_json summary = {
      {"summary", {{"points", survey.points_written()}, {"file", arguments.out}}}};
  std::printf("%s\n", summary.dump().c_str());
  return done;
}

RunVerb declare_survey(OptionParser& app) {
  const auto arguments = std::make_shared<SurveyVerbArguments>();
  app.add_option("SITE", arguments->site, "Directory with site.toml")->required();
  app.add_option("--out",
                 arguments->out,
                 "The points file; one that exists is continued, with recordings of its own")
      ->required();
  app.add_option("--listen",
                 arguments->listen,
                 "Where access points send to: [AP=]HOST:PORT, or [AP=] and " +
                     transport_syntax(transport_schemes(), TransportUse::kLiveSource));
  app.add_option("--config", arguments->config, "Take the live sources of raylocd's configuration");
  app.add_option("--site",
                 arguments->name,
                 "With several sites there, the name of one; default: the site of this directory");
  app.add_option("--record", arguments->record, "Also record what arrives: [AP=]FILE.pcap");
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
