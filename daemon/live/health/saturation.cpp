#include "daemon/live/health/saturation.h"

#include <algorithm>

#include <fmt/format.h>

namespace rayloc {

std::string overload_text(const std::string& consequence) {
  return "more bursts come than this machine can explain: " + consequence +
         "; locate fewer devices (unlisted = \"ignore\" in [targets] of site.toml, a filter of "
         "addresses at the access point) or take a faster machine";
}

void Saturation::compare(const std::string& reason, std::uint64_t lost, Time now, Queues& queues) {
  Queue& queue = queues[reason];
  if (lost > queue.lost) {
    queue = {lost, now, true};
  }
  queue.lately = queue.lately && now - queue.last_loss < kLately;
}

void Saturation::check(const v1::Heartbeat& heartbeat, Time now) {
  const bool was_overloaded = !lately(bursts_).empty();
  const auto seconds = kLately.count();
  for (const v1::SourceReport& source : heartbeat.sources()) {
    const std::string& name = source.access_point();
    const v1::SourceCounters& counters = source.counters();
    compare(fmt::format("source {}: datagrams were lost before we read them in the last {} s, see "
                        "rayloc doctor",
                        name,
                        seconds),
            counters.kernel_drops(),
            now,
            queues_);
    compare(fmt::format("source {}: datagrams were dropped in the last {} s", name, seconds),
            counters.ring_dropped(),
            now,
            queues_);
    compare(fmt::format("source {}: frames were dropped in the last {} s: estimates take longer "
                        "than frames to come",
                        name,
                        seconds),
            counters.frames_dropped(),
            now,
            queues_);
  }
  compare(
      fmt::format("events were dropped in the last {} s: the publisher does not keep up", seconds),
      heartbeat.estimation().events_dropped(),
      now,
      queues_);
  compare(fmt::format("frames of CSI were not published in the last {} s: the publisher does not "
                      "keep up",
                      seconds),
          heartbeat.publisher().csi_dropped(),
          now,
          queues_);
  compare(
      fmt::format("in the last {} s bursts gave way to newer ones of their device, so there are "
                  "fewer estimates",
                  seconds),
      heartbeat.estimation().bursts_merged(),
      now,
      bursts_);
  compare(fmt::format("in the last {} s bursts waited until they were too old, and were left out; "
                      "transmitters of site.toml come first",
                      seconds),
          heartbeat.estimation().bursts_dropped(),
          now,
          bursts_);
  has_recovered_ = was_overloaded && lately(bursts_).empty();
  samples_.push_back({now, heartbeat.estimation()});
  while (samples_.size() > 2 && now - samples_[1].time >= kLately) {
    samples_.pop_front();
  }
}

// Share of the recently ended bursts.
double Saturation::explained_share() const {
  const v1::EstimationCounters& from = samples_.front().counters;
  const v1::EstimationCounters& to = samples_.back().counters;
  const std::uint64_t explained = to.bursts() - from.bursts();
  const std::uint64_t all = explained + to.bursts_merged() - from.bursts_merged() +
                            to.bursts_dropped() - from.bursts_dropped();
  return all > 0 ? static_cast<double>(explained) / static_cast<double>(all) : 1.0;
}

// "; a second: listed 9.8 of 10.0, unlisted acquisition 1.5 of 240.3": the ranks with recent
// bursts.
std::string Saturation::rates() const {
  const auto& from = samples_.front().counters.ranks();
  const auto& to = samples_.back().counters.ranks();
  const double seconds =
      std::chrono::duration<double>(samples_.back().time - samples_.front().time).count();
  std::string text;
  for (int i = 0; i < std::min(from.size(), to.size()); ++i) {
    if (to[i].bursts() == from[i].bursts()) {
      continue;
    }
    const auto rate = [&](std::uint64_t later, std::uint64_t earlier) {
      return static_cast<double>(later - earlier) / seconds;
    };
    std::string rank = to[i].rank();
    std::replace(rank.begin(), rank.end(), '_', ' ');
    text += fmt::format("{}{} {:.1f} of {:.1f}",
                        text.empty() ? "; a second: " : ", ",
                        rank,
                        rate(to[i].bursts_explained(), from[i].bursts_explained()),
                        rate(to[i].bursts(), from[i].bursts()));
  }
  return text;
}

std::vector<std::string> Saturation::lately(const Queues& queues) {
  std::vector<std::string> reasons;
  for (const auto& [reason, queue] : queues) {
    if (queue.lately) {
      reasons.push_back(reason);
    }
  }
  return reasons;
}

std::vector<std::string> Saturation::reasons() const { return lately(queues_); }

std::vector<std::string> Saturation::warnings() const {
  std::vector<std::string> warnings;
  for (const std::string& consequence : lately(bursts_)) {
    warnings.push_back(overload_text(fmt::format("{} ({:.0f} % of the bursts were explained{})",
                                                 consequence,
                                                 100.0 * explained_share(),
                                                 rates())));
  }
  return warnings;
}

}  // namespace rayloc
