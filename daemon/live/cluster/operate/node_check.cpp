#include "daemon/live/cluster/operate/node_check.h"

#include <chrono>

#include <fmt/format.h>

#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr double kMaxNodeSilence = 5.0;   // s; a capture node sends ten heartbeats a second
constexpr double kMaxClockAdvance = 0.1;  // s: above the transit time of a message

}  // namespace

std::vector<Finding> check_node(const NodeReport& report, Timestamp now) {
  std::vector<Finding> findings;
  const std::string what = "capture node " + printable(report.node) + " of " + report.stream;
  const double age = to_seconds(now - report.stored);
  if (age > kMaxNodeSilence) {
    findings.push_back(Finding::problem(fmt::format("{} has sent nothing for {:.0f} s", what, age),
                                        "check that raylocd runs on it and reaches the servers"));
  } else if (!report.last.clock_synchronised()) {
    findings.push_back(Finding::warning(what + ": its clock is not synchronized",
                                        "run chrony or systemd-timesyncd on it"));
  } else {
    findings.push_back(Finding::ok(what + " is sending"));
  }
  for (const v1::ApPart& part : report.last.parts()) {
    const Timestamp watermark{std::chrono::microseconds(part.watermark_us())};
    if (const double ahead = to_seconds(watermark - report.stored); ahead > kMaxClockAdvance) {
      findings.push_back(Finding::problem(
          fmt::format("{}: its clock is {:.2f} s ahead of the server's", what, ahead),
          "synchronize both with NTP"));
      break;
    }
  }
  return findings;
}

}  // namespace rayloc
