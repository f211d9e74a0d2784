// `rayloc top`: activity of a running raylocd, live on the terminal or once as a table.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "daemon/cli/feed/message_source.h"
#include "daemon/cli/feed/top_model.h"
#include "daemon/cli/feed/top_sites.h"
#include "daemon/cli/feed/top_snapshot.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/terminal/terminal_screen.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

using TopClock = TopModel::Clock;

struct TopArguments {
  MessageSource from;
  std::string site;  // one of several; empty: all
  bool once = false;
  double interval = 1.0;  // [s] between two screens
  double timeout = 10.0;  // [s] to wait for heartbeats, with `once`
};

// Receives messages until `until`; returns early when `stop` holds.
template <typename Stop>
void collect(const Receive& receive, TopClock::time_point until, TopSites& sites, Stop stop) {
  constexpr auto kPoll = std::chrono::milliseconds(100);
  for (auto now = TopClock::now(); now < until && !stop(); now = TopClock::now()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now);
    if (const auto message = receive(std::min(kPoll, left))) {
      sites.add(*message, TopClock::now());
    }
  }
}

TopClock::duration seconds(double count) {
  return std::chrono::duration_cast<TopClock::duration>(std::chrono::duration<double>(count));
}

// Two heartbeats suffice for every rate, and a locating daemon has published meanwhile.
Expected<void> print_once(const Receive& receive, const TopArguments& arguments) {
  constexpr std::uint64_t kHeartbeats = 2;
  StopSignal::install();
  TopSites sites(arguments.site);
  collect(receive, TopClock::now() + seconds(arguments.timeout), sites, [&] {
    return StopSignal::requested() || sites.is_complete(kHeartbeats);
  });
  if (!sites.has_heartbeat()) {
    return make_error(
        ErrorKind::kUnavailable,
        "no heartbeat from " + arguments.from.endpoint + "; is raylocd running there?");
  }
  if (!sites.has_shown_site()) {
    return make_error(ErrorKind::kUsage, "no site is called '" + arguments.site + "' there");
  }
  for (const std::string& line : sites.lines(TopClock::now())) {
    std::printf("%s\n", line.c_str());
  }
  return {};
}

void show(const Receive& receive, const TopArguments& arguments) {
  TopSites sites(arguments.site);
  TerminalScreen screen;
  bool is_wanted = true;
  const auto heed_keys = [&] {
    while (const auto key = screen.key()) {
      is_wanted = is_wanted && *key != 'q' && *key != 'Q';
    }
    return !is_wanted || screen.ended() || screen.is_stale();
  };
  while (is_wanted && !screen.ended()) {
    std::vector<std::string> lines = sites.lines(TopClock::now(), TerminalScreen::columns());
    lines.emplace_back();
    lines.emplace_back("q ends");
    if (!screen.draw(lines)) {
      return;
    }
    collect(receive, TopClock::now() + seconds(arguments.interval), sites, heed_keys);
  }
}

Expected<void> run_top(const TopArguments& arguments) {
  const Expected<Receive> receive = connect_with_snapshot(arguments.from, arguments.timeout);
  RAYLOC_TRY(receive);
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
