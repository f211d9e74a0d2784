// `rayloc sub`: prints what raylocd publishes.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "daemon/cli/feed/feed_follower.h"
#include "daemon/cli/feed/feed_writer.h"
#include "daemon/cli/feed/message_filter.h"
#include "daemon/cli/feed/message_source.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

struct SubArguments {
  FeedRequest request;
  MessageSource from;
  std::string format = "text";
  bool json = false;
  double timeout = 0.0;  // [s]; 0: none
};

Expected<void> print_message_line(const std::string& line) {
  if (std::fputs(line.c_str(), stdout) < 0 || std::fputc('\n', stdout) == EOF ||
      std::fflush(stdout) != 0) {
    return make_error(ErrorKind::kUnavailable, "standard output cannot be written");
  }
  return {};
}

void print_feed_note(const std::string& note) {
  std::fprintf(stderr, "rayloc sub: %s\n", note.c_str());
}

FeedFormat format_of(const SubArguments& arguments) {
  const auto& names = feed_format_names();
  const std::string& name = arguments.json ? "json" : arguments.format;
  return static_cast<FeedFormat>(std::find(names.begin(), names.end(), name) - names.begin());
}

Expected<void> run_sub(const SubArguments& arguments) {
  FeedRequest request = arguments.request;
  request.format = format_of(arguments);
  FeedFollower feed(request, {print_message_line, print_feed_note});
  const Expected<Receive> receive = connect(arguments.from, feed.prefixes());
  RAYLOC_TRY(receive);
  StopSignal::install();
  RAYLOC_TRY(feed.begin());
  const auto is_silent = [&] {
    const std::chrono::duration<double> silence = feed.silence();
    return !StopSignal::requested() && arguments.timeout > 0.0 &&
           silence.count() >= arguments.timeout;
  };
  while (!StopSignal::requested() && !feed.is_done()) {
    const auto message = (*receive)(std::chrono::milliseconds(200));
    if (!message && is_silent()) {
      return make_error(
          ErrorKind::kUnavailable,
          "no message from " + arguments.from.endpoint + "; is raylocd running there?");
    }
    RAYLOC_TRY(message ? feed.take(*message) : Expected<void>());
  }
  feed.report_left_out();
  return {};
}

void declare_filter(OptionParser& app, MessageFilter& filter) {
  app.add_option("--target",
                 filter.targets,
                 "Only of these targets: as in the topic (MAC, hash, person-N), or the name in "
                 "site.toml");
  app.add_option("--kind", filter.kind, "Only locations of one burst, or those of the tracker")
      ->check(one_of({"snapshot", "filtered"}));
  app.add_option("--zone",
                 filter.zones,
                 "Only locations that are probably in one of these zones, and events of them");
  app.add_option("--zone-probability",
                 filter.zone_probability,
                 "From which probability on a location is in a zone")
      ->check(in_range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--max-accuracy", filter.max_accuracy, "Only locations at least so accurate [m]")
      ->check(not_negative());
  app.add_option("--min-confidence",
                 filter.min_confidence,
                 "Only locations whose likeliest place is at least so probable")
      ->check(in_range(0.0, 1.0));
}

RunVerb declare_sub(OptionParser& app) {
  auto arguments = std::make_shared<SubArguments>();
  app.add_option("TOPIC",
                 arguments->request.topics,
                 "Prefixes of the topics; default: all, with csv, geojson and omlox v1/location/");
  add_source_options(app, arguments->from);
  app.add_option("--format",
                 arguments->format,
                 "text: for people; json: every Envelope; locations alone: csv, geojson (WGS 84 by "
                 "the site's georeference), omlox")
      ->check(one_of(feed_format_names()))
      ->capture_default_str();
  app.add_flag("--json", arguments->json, "The same as --format json");
  declare_filter(app, arguments->request.filter);
  app.add_option("--count", arguments->request.count, "Stop after this many messages");
  app.add_option(
         "--timeout", arguments->timeout, "Stop with status 69 after so many silent seconds")
      ->check(not_negative());
  return [arguments] { return run_sub(*arguments); };
}

}  // namespace

extern const Verb kSub{
    "sub",
    "Print what raylocd publishes, one message per line",
    "rayloc sub --json v1/location/\n"
    "  rayloc sub --target 02:52:4c:00:00:01 --kind filtered --max-accuracy 0.5\n"
    "  rayloc sub v1/zone/ v1/location/ --zone desk\n"
    "  rayloc sub --format csv --kind snapshot --count 100 > fixes.csv\n"
    "  rayloc sub --format geojson | jq --unbuffered .geometry\n"
    "  rayloc sub --format omlox --snapshot tcp://127.0.0.1:5561",
    declare_sub};

}  // namespace rayloc::cli
