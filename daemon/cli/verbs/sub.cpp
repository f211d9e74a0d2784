// `rayloc sub`: prints what raylocd publishes.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/feed/feed_writer.h"
#include "daemon/cli/feed/message_filter.h"
#include "daemon/cli/feed/message_source.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/messages/gap_detector.h"
#include "daemon/messages/topic.h"
#include "engine/base/printable.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::cli {
namespace {

struct SubArguments {
  std::vector<std::string> topics;
  MessageSource from;
  std::string format = "text";
  bool json = false;
  MessageFilter filter;
  std::uint64_t count = 0;  // 0: no end
  double timeout = 0.0;     // [s]; 0: none
};

Expected<void> print_message_line(const std::string& line) {
  if (std::fputs(line.c_str(), stdout) < 0 || std::fputc('\n', stdout) == EOF ||
      std::fflush(stdout) != 0) {
    return make_error(ErrorKind::kUnavailable, "standard output cannot be written");
  }
  return {};
}

void report_losses(GapDetector& gaps, const std::string& topic, const v1::Envelope& envelope) {
  const std::uint64_t restarts = gaps.restarts();
  for (const GapDetector::Gap& gap : gaps.add(topic, envelope)) {
    std::fprintf(stderr,
                 "rayloc sub: lost %llu messages of %s\n",
                 static_cast<unsigned long long>(gap.lost),  // NOLINT(google-runtime-int)
                 printable(gap.topic).c_str());
  }
  if (gaps.restarts() != restarts) {
    std::fprintf(stderr, "rayloc sub: the daemon was restarted\n");
  }
}

// The running verb.
class Subscription {
 public:
  Subscription(const SubArguments& arguments, FeedFormat format)
      : arguments_(arguments), writer_(format), topics_(arguments.topics) {
    if (topics_.empty()) {
      topics_ = {writer_.is_of_locations_only() ? "v1/location/" : "v1/"};
    }
  }

  Expected<void> run() {
    std::vector<std::string> prefixes = topics_;
    if (writer_.needs_heartbeats()) {
      prefixes.emplace_back(kHeartbeatTopics);
    }
    const Expected<Receive> receive = connect(arguments_.from, prefixes);
    if (!receive) {
      return tl::make_unexpected(receive.error());
    }
    StopSignal::install();
    if (const auto header = writer_.header()) {
      if (auto written = print_message_line(*header); !written) {
        return written;
      }
    }
    while (!StopSignal::requested() && !is_done()) {
      const auto message = (*receive)(std::chrono::milliseconds(200));
      if (!message && is_silent()) {
        return make_error(
            ErrorKind::kUnavailable,
            "no message from " + arguments_.from.endpoint + "; is raylocd running there?");
      }
      if (auto taken = message ? take(*message) : Expected<void>(); !taken) {
        return taken;
      }
    }
    report_left_out();
    return {};
  }

 private:
  bool is_done() const { return arguments_.count != 0 && printed_ >= arguments_.count; }

  bool is_silent() const {
    const std::chrono::duration<double> silence = std::chrono::steady_clock::now() - last_;
    return !StopSignal::requested() && arguments_.timeout > 0.0 &&
           silence.count() >= arguments_.timeout;
  }

  bool is_asked_for(const std::string& topic) const {
    return std::any_of(topics_.begin(), topics_.end(), [&](const std::string& prefix) {
      return topic.starts_with(prefix);
    });
  }

  Expected<void> take(const PublishedMessage& message) {
    v1::Envelope envelope;
    if (!envelope.ParseFromString(message.payload)) {
      std::fprintf(
          stderr, "rayloc sub: a message of %s is no Envelope\n", printable(message.topic).c_str());
      return {};
    }
    report_losses(gaps_, message.topic, envelope);
    if (envelope.has_heartbeat() && writer_.needs_heartbeats()) {
      if (auto received = writer_.receive(envelope.heartbeat()); !received) {
        return received;
      }
    }
    if (is_asked_for(message.topic)) {
      last_ = std::chrono::steady_clock::now();
      if (arguments_.filter.passes(envelope)) {
        writer_.add(std::move(envelope));
      }
    }
    return print_due();
  }

  Expected<void> print_due() {
    while (!is_done()) {
      const std::optional<std::string> line = writer_.next();
      if (!line) {
        return {};
      }
      if (auto written = print_message_line(*line); !written) {
        return written;
      }
      ++printed_;
    }
    return {};
  }

  void report_left_out() const {
    const auto report = [](std::uint64_t count, const char* what) {
      if (count > 0) {
        std::fprintf(stderr,
                     "rayloc sub: %llu messages %s\n",
                     static_cast<unsigned long long>(count),  // NOLINT(google-runtime-int)
                     what);
      }
    };
    report(writer_.without_form(), "have no form in this format and were left out");
    report(writer_.dropped(), "were dropped while no heartbeat came");
  }

  const SubArguments& arguments_;
  FeedWriter writer_;
  std::vector<std::string> topics_;
  GapDetector gaps_;
  std::uint64_t printed_ = 0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

Expected<void> run_sub(const SubArguments& arguments) {
  const auto& names = feed_format_names();
  const std::string& name = arguments.json ? "json" : arguments.format;
  const auto index = std::find(names.begin(), names.end(), name) - names.begin();
  return Subscription(arguments, static_cast<FeedFormat>(index)).run();
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
                 arguments->topics,
                 "Prefixes of the topics; default: all, with csv, geojson and omlox v1/location/");
  add_source_options(app, arguments->from);
  app.add_option("--format",
                 arguments->format,
                 "text: for people; json: every Envelope; locations alone: csv, geojson (WGS 84 by "
                 "the site's georeference), omlox")
      ->check(one_of(feed_format_names()))
      ->capture_default_str();
  app.add_flag("--json", arguments->json, "The same as --format json");
  declare_filter(app, arguments->filter);
  app.add_option("--count", arguments->count, "Stop after this many messages");
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
