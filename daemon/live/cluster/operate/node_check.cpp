#include "daemon/live/cluster/operate/node_check.h"

#include <chrono>

#include <fmt/format.h>

#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr double kMaxNodeSilence = 5.0;   // s; a capture node sends ten signs of life a second
constexpr double kMaxClockAdvance = 0.1;  // s: above the transit time of a message

}  // namespace

std::vector<Finding> check_node(const NodeReport& report, Timestamp now) {
  std::vector<Finding> findings;
  const std::string what = "capture node " + printable(report.node) + " of " + report.stream;
  const double age = to_seconds(now - report.stored);
  if (age > kMaxNodeSilence) {
    findings.push_back(Finding::problem(fmt::format("{} is silent for {:.0f} s", what, age),
                                        "see whether raylocd runs there and reaches the servers"));
  } else if (!report.last.clock_synchronised()) {
    findings.push_back(Finding::warning(what + ": its clock is not synchronised",
                                        "run chrony or systemd-timesyncd there"));
  } else {
    findings.push_back(Finding::ok(what + " sends"));
  }
  for (const v1::ApPart& part : report.last.parts()) {
    const Timestamp watermark{std::chrono::microseconds(part.watermark_us())};
    if (const double ahead = to_seconds(watermark - report.stored); ahead > kMaxClockAdvance) {
      findings.push_back(Finding::problem(
          fmt::format("{}: its clock is {:.2f} s before the server's", what, ahead),
          "set both by NTP"));
      break;
    }
  }
  return findings;
}

}  // namespace rayloc
