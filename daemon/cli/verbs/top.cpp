// `rayloc top`: activity of a running raylocd, live on the terminal or once as a table.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/feed/message_source.h"
#include "daemon/cli/feed/top_model.h"
#include "daemon/cli/feed/top_snapshot.h"
#include "daemon/cli/feed/top_view.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/terminal/terminal_screen.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/messages/topic.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

using TopClock = TopModel::Clock;
// By the site in the topics; a raylocd may have several.
using Models = std::map<std::string, TopModel>;

struct TopArguments {
  MessageSource from;
  std::string site;  // one of several; empty: all
  bool once = false;
  double interval = 1.0;  // [s] between two screens
  double timeout = 10.0;  // [s] to wait for heartbeats, with `once`
};

// Receives messages until `until`; returns early when `stop` holds.
template <typename Stop>
void collect(const Receive& receive, TopClock::time_point until, Models& models, Stop stop) {
  constexpr auto kPoll = std::chrono::milliseconds(100);
  for (auto now = TopClock::now(); now < until && !stop(); now = TopClock::now()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now);
    if (const auto message = receive(std::min(kPoll, left))) {
      v1::Envelope envelope;
      if (envelope.ParseFromString(message->payload)) {
        models[std::string(topic_site(message->topic))].add(
            message->topic, envelope, TopClock::now(), message->from_snapshot);
      }
    }
  }
}

bool is_wanted(const std::string& component, const std::string& only) {
  return only.empty() || decoded_component(component) == only;
}

// The sites one below the other, each with its name if there are several.
std::vector<std::string> lines_of(const Models& models,
                                  const std::string& only,
                                  std::size_t width = kAnyWidth) {
  std::vector<std::string> lines;
  for (const auto& [site, model] : models) {
    const std::string name = decoded_component(site);
    if (!is_wanted(site, only)) {
      continue;
    }
    if (models.size() > 1 && only.empty()) {
      lines.insert(lines.end(), lines.empty() ? 0U : 1U, "");
      lines.push_back("site " + printable(name));
    }
    for (std::string& line : top_lines(model, TopClock::now(), width)) {
      lines.push_back(std::move(line));
    }
  }
  return lines.empty() ? top_lines(TopModel(), TopClock::now(), width) : lines;
}

TopClock::duration seconds(double count) {
  return std::chrono::duration_cast<TopClock::duration>(std::chrono::duration<double>(count));
}

// Two heartbeats suffice for every rate, and a locating daemon has published meanwhile.
Expected<void> print_once(const Receive& receive, const TopArguments& arguments) {
  constexpr std::uint64_t kHeartbeats = 2;
  StopSignal::install();
  Models models;
  collect(receive, TopClock::now() + seconds(arguments.timeout), models, [&] {
    return StopSignal::requested() ||
           (!models.empty() && std::all_of(models.begin(), models.end(), [&](const auto& one) {
             return !is_wanted(one.first, arguments.site) ||
                    one.second.heartbeats() >= kHeartbeats || one.second.goodbye();
           }));
  });
  if (std::none_of(models.begin(), models.end(), [](const auto& one) {
        return one.second.heartbeat().has_value();
      })) {
    return make_error(
        ErrorKind::kUnavailable,
        "no heartbeat from " + arguments.from.endpoint + "; is raylocd running there?");
  }
  if (std::none_of(models.begin(), models.end(), [&](const auto& one) {
        return is_wanted(one.first, arguments.site);
      })) {
    return make_error(ErrorKind::kUsage, "no site is called '" + arguments.site + "' there");
  }
  for (const std::string& line : lines_of(models, arguments.site)) {
    std::printf("%s\n", line.c_str());
  }
  return {};
}

void show(const Receive& receive, const TopArguments& arguments) {
  Models models;
  TerminalScreen screen;
  bool is_wanted = true;
  const auto heed_keys = [&] {
    while (const auto key = screen.key()) {
      is_wanted = is_wanted && *key != 'q' && *key != 'Q';
    }
    return !is_wanted || screen.ended() || screen.is_stale();
  };
  while (is_wanted && !screen.ended()) {
    std::vector<std::string> lines = lines_of(models, arguments.site, TerminalScreen::columns());
    lines.emplace_back();
    lines.emplace_back("q ends");
    if (!screen.draw(lines)) {
      return;
    }
    collect(receive, TopClock::now() + seconds(arguments.interval), models, heed_keys);
  }
}

// Connects with a snapshot of the last messages, so that zones and quiet targets are available at
// once. If no snapshot is given or found at the usual address, it connects without one.
Expected<Receive> connect_top(const MessageSource& from, double patience) {
  constexpr double kMaxPatience = 2.0;  // [s]
  const std::vector<std::string> all = {"v1/"};
  const std::optional<std::string> usual =
      from.snapshot.empty() ? usual_snapshot(from.endpoint) : std::nullopt;
  if (usual) {
    MessageSource late = from;
    late.snapshot = *usual;
    late.patience =
        std::chrono::milliseconds(std::llround(1000.0 * std::min(patience, kMaxPatience)));
    if (Expected<Receive> receive = connect(late, all)) {
      return receive;
    }
  }
  return connect(from, all);
}

Expected<void> run_top(const TopArguments& arguments) {
  const Expected<Receive> receive = connect_top(arguments.from, arguments.timeout);
  if (!receive) {
    return tl::make_unexpected(receive.error());
  }
  if (arguments.once || !TerminalScreen::is_possible()) {
    return print_once(*receive, arguments);
  }
  show(*receive, arguments);
  return {};
}

RunVerb declare_top(OptionParser& app) {
  const auto arguments = std::make_shared<TopArguments>();
  add_source_options(app, arguments->from);
  app.get_option("--snapshot")
      ->description(
          "Endpoint that has the last message of each topic; default: port 5561 where the "
          "endpoint's is 5560");
  app.add_option("--site", arguments->site, "Only the site of this name");
  app.add_flag("--once",
               arguments->once,
               "Print one table after the second heartbeat and end; so it is where standard output "
               "is no terminal");
  app.add_option("--interval", arguments->interval, "Seconds between two pictures")
      ->check(in_range(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--timeout",
                 arguments->timeout,
                 "With --once: seconds to wait for heartbeats; none is status 69")
      ->check(not_negative())
      ->capture_default_str();
  return [arguments] { return run_top(*arguments); };
}

}  // namespace

extern const Verb kTop;
const Verb kTop = {"top",
                   "Watch targets, zones, access points and losses of a running raylocd",
                   "rayloc top\n"
                   "  rayloc top --endpoint tcp://192.0.2.7:5560 --snapshot tcp://192.0.2.7:5561\n"
                   "  rayloc top --once | grep NO",
                   declare_top};

}  // namespace rayloc::cli
