#include "daemon/pipeline/burst_collector.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace rayloc {

BurstCollector::BurstCollector(CollectorOptions options, const OpenBursts& begin)
    : options_(std::move(options)), begin_(begin.at) {
  for (const BurstStart& start : begin.starts) {
    Burst& burst = open_[start.transmitter];
    burst.transmitter = start.transmitter;
    burst.first = start.first;
    burst.received_since = start.first;
    burst.last = start.last;
  }
}

OpenBursts BurstCollector::open_starts(Timestamp time) const {
  OpenBursts open{time, {}};
  open.starts.reserve(open_.size());
  for (const auto& [mac, burst] : open_) {
    open.starts.push_back({mac, burst.first, burst.last});
  }
  return open;
}

Timestamp BurstCollector::end_of(const Burst& burst) const {
  return std::min(burst.first + options_.length, burst.last + options_.gap);
}

void BurstCollector::add(CsiFrame&& frame, std::vector<Burst>& ended) {
  advance(frame.time, ended);
  auto found = open_.find(frame.transmitter);
  if (frame.time < begin_ && (found == open_.end() || frame.time < found->second.first)) {
    ++passed_over_;
    return;
  }
  if (found == open_.end()) {
    if (open_.size() >= options_.max_transmitters && !options_.wanted(frame.transmitter)) {
      ++refused_;
      return;
    }
    found = open_.emplace(frame.transmitter, Burst{}).first;
    found->second.transmitter = frame.transmitter;
    found->second.first = frame.time;
    found->second.received_since = frame.time;
  }
  Burst& burst = found->second;
  burst.last = std::max(burst.last, frame.time);
  keep(burst, std::move(frame));
}

void BurstCollector::keep(Burst& burst, CsiFrame&& frame) const {
  Burst::Sampling& sampling = burst.sampling[{frame.access_point, frame.channel}];
  if (sampling.seen++ % sampling.stride != 0) {
    ++burst.surplus;
    return;
  }
  if (sampling.kept == options_.max_frames) {
    // Removes every second frame of this access point and channel; the first one stays.
    std::size_t index = 0;
    const auto left_out = [&](const CsiFrame& kept) {
      return kept.access_point == frame.access_point && kept.channel == frame.channel &&
             index++ % 2 == 1;
    };
    burst.surplus += std::erase_if(burst.frames, left_out);
    sampling.kept -= sampling.kept / 2;
    sampling.stride *= 2;
    if ((sampling.seen - 1) % sampling.stride != 0) {
      ++burst.surplus;
      return;
    }
  }
  ++sampling.kept;
  burst.frames.push_back(std::move(frame));
}

void BurstCollector::advance(Timestamp time, std::vector<Burst>& ended) {
  const std::size_t before = ended.size();
  for (auto it = open_.begin(); it != open_.end();) {
    if (end_of(it->second) <= time) {
      if (!it->second.frames.empty()) {  // false: no frame of an initially open burst arrived
        ended.push_back(std::move(it->second));
      }
      it = open_.erase(it);
    } else {
      ++it;
    }
  }
  std::sort(ended.begin() + static_cast<std::ptrdiff_t>(before),
            ended.end(),
            [&](const Burst& a, const Burst& b) {
              return std::tuple(end_of(a), a.transmitter) < std::tuple(end_of(b), b.transmitter);
            });
}

Timestamp BurstCollector::latest_end() const {
  Timestamp latest = Timestamp::min();
  for (const auto& [mac, burst] : open_) {
    latest = std::max(latest, end_of(burst));
  }
  return latest;
}

std::uint64_t BurstCollector::in_flight() const {
  std::uint64_t frames = 0;
  for (const auto& [mac, burst] : open_) {
    frames += burst.frames.size() + burst.surplus;
  }
  return frames;
}

Timestamp BurstCollector::earliest_open(Timestamp time) const {
  for (const auto& [mac, burst] : open_) {
    time = std::min(time, burst.first);
  }
  return time;
}

}  // namespace rayloc
