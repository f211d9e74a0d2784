// `rayloc sub`: prints what raylocd publishes.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "daemon/cli/message_line.h"
#include "daemon/cli/stop_signal.h"
#include "daemon/cli/verbs.h"
#include "daemon/publish/gap_detector.h"
#include "daemon/publish/json.h"
#include "daemon/publish/subscriber.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::cli {
namespace {

struct SubArguments {
  std::vector<std::string> topics;
  std::string endpoint = "tcp://127.0.0.1:5560";
  bool json = false;
  std::uint64_t count = 0;  // 0: no end
  double timeout = 0.0;     // [s]; 0: none
};

Expected<void> print_line(const std::string& line) {
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
                 gap.topic.c_str());
  }
  if (gaps.restarts() != restarts) {
    std::fprintf(stderr, "rayloc sub: the daemon was restarted\n");
  }
}

Expected<void> run_sub(const SubArguments& arguments) {
  auto subscriber = Subscriber::connect(
      arguments.endpoint,
      arguments.topics.empty() ? std::vector<std::string>{"v1/"} : arguments.topics);
  if (!subscriber) {
    return tl::make_unexpected(subscriber.error());
  }
  StopSignal::install();
  GapDetector gaps;
  std::uint64_t printed = 0;
  auto last = std::chrono::steady_clock::now();
  while (!StopSignal::requested() && (arguments.count == 0 || printed < arguments.count)) {
    const auto message = subscriber->receive(std::chrono::milliseconds(200));
    if (!message) {
      const std::chrono::duration<double> silence = std::chrono::steady_clock::now() - last;
      if (!StopSignal::requested() && arguments.timeout > 0.0 &&
          silence.count() >= arguments.timeout) {
        return make_error(ErrorKind::kUnavailable,
                          "no message from " + arguments.endpoint + "; is raylocd running there?");
      }
      continue;
    }
    last = std::chrono::steady_clock::now();
    v1::Envelope envelope;
    if (!envelope.ParseFromString(message->payload)) {
      std::fprintf(stderr, "rayloc sub: a message of %s is no Envelope\n", message->topic.c_str());
      continue;
    }
    report_losses(gaps, message->topic, envelope);
    const auto line =
        arguments.json ? to_json(envelope) : Expected<std::string>(message_line(envelope));
    if (!line) {
      std::fprintf(stderr, "rayloc sub: %s\n", line.error().message.c_str());
      continue;
    }
    if (auto written = print_line(*line); !written) {
      return written;
    }
    ++printed;
  }
  return {};
}

RunVerb declare_sub(CLI::App& app) {
  auto arguments = std::make_shared<SubArguments>();
  app.add_option("TOPIC", arguments->topics, "What the topics begin with; all unless told");
  app.add_option("--endpoint", arguments->endpoint, "Where raylocd publishes")
      ->capture_default_str();
  app.add_flag("--json", arguments->json, "One Envelope per line as JSON");
  app.add_option("--count", arguments->count, "Stop after this many messages");
  app.add_option(
         "--timeout", arguments->timeout, "Stop with status 69 after so many silent seconds")
      ->check(CLI::NonNegativeNumber);
  return [arguments] { return run_sub(*arguments); };
}

}  // namespace

extern const Verb kSub{"sub",
                       "Print what raylocd publishes, one message per line",
                       "rayloc sub --json v1/location/",
                       declare_sub};

}  // namespace rayloc::cli
