#include "daemon/pipeline/playback/recording_sender.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <span>
#include <utility>
#include <vector>

namespace rayloc {
namespace {

// CLOCK_MONOTONIC
Duration monotonic_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::chrono::seconds(now.tv_sec) + Duration(now.tv_nsec);
}

// The datagram as the access point would send it now.
Datagram sent_now(const DatagramAddress& address, std::span<const std::byte> payload) {
  return {std::chrono::system_clock::now(), address, payload};
}

struct KeptDatagram {
  std::size_t recording;
  DatagramAddress address;
  std::vector<std::byte> payload;
};

Expected<std::vector<KeptDatagram>> keep_all(MergedRecordings& recordings) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 30;
  std::vector<KeptDatagram> all;
  std::size_t bytes = 0;
  for (auto next = recordings.next(); !next || next->datagram != nullptr;
       next = recordings.next()) {
    RAYLOC_TRY(next);
    const auto& payload = next->datagram->payload;
    bytes += payload.size() + sizeof(KeptDatagram);
    if (bytes > kMaxBytes) {
      return make_error(ErrorKind::kUsage,
                        "--rate keeps the recording in memory, at most 1 GiB; send a part of it");
    }
    all.push_back({next->recording, next->datagram->address, {payload.begin(), payload.end()}});
  }
  return all;
}

}  // namespace

RecordingSender::RecordingSender(MergedRecordings& recordings,
                                 SinkQueue& sinks,
                                 SendObserver observer,
                                 std::function<bool()> is_stopped)
    : recordings_(recordings),
      sinks_(sinks),
      observer_(std::move(observer)),
      is_stopped_(std::move(is_stopped)) {}

Expected<SendOutcome> RecordingSender::send_paced(const PacedSending& options) {
  // Lead time, so that the first datagram is not late.
  constexpr Duration kLead = std::chrono::milliseconds(20);
  const double speed = options.speed;
  auto next = recordings_.next();
  const Duration begin = monotonic_now() + kLead;
  Timestamp first = next && next->datagram != nullptr ? next->datagram->time : Timestamp{};
  Timestamp latest = first;
  const Timestamp wall = std::chrono::system_clock::now() + kLead;
  // At another speed no single offset converts recorded times to arrival times.
  const auto time_offset = [&] {
    return speed == 1.0 ? std::optional<Duration>(wall - first) : std::nullopt;
  };
  report_start(time_offset());
  SendOutcome outcome;
  const Duration end = options.duration ? begin + from_seconds(*options.duration) : Duration::max();
  while (next && next->datagram != nullptr && !is_stopped_()) {
    const Datagram& datagram = *next->datagram;
    if (const Duration gap = datagram.time - latest;
        gap > options.max_gap && std::isfinite(speed)) {
      first += gap - options.max_gap;
      if (observer_.on_gap) {
        observer_.on_gap(gap, gap - options.max_gap, time_offset());
      }
    }
    latest = std::max(latest, datagram.time);
    const Duration due = begin + from_seconds(to_seconds(datagram.time - first) / speed);
    if (due > end) {
      break;
    }
    if (due > monotonic_now()) {
      RAYLOC_TRY(sinks_.flush());
      sleep_until(due);
    }
    if (std::isfinite(speed)) {
      outcome.latest = std::max(outcome.latest, monotonic_now() - due);
    }
    RAYLOC_TRY(sinks_.queue(next->recording, sent_now(datagram.address, datagram.payload)));
    next = recordings_.next();
  }
  RAYLOC_TRY(sinks_.flush());
  outcome.elapsed = monotonic_now() - begin;
  return next ? Expected<SendOutcome>(outcome) : tl::make_unexpected(std::move(next.error()));
}

// Counts the datagrams due since the beginning: errors do not add up.
Expected<SendOutcome> RecordingSender::send_at_rate(double rate, std::optional<double> duration) {
  // Longest time that datagrams may wait to leave together.
  constexpr Duration kTick = std::chrono::milliseconds(1);
  // A machine that cannot keep the rate does not send much longer than the requested duration.
  constexpr Duration kGrace = std::chrono::milliseconds(100);
  auto kept = keep_all(recordings_);
  RAYLOC_TRY(kept);
  report_start(std::nullopt);
  const std::uint64_t total = kept->empty() ? 0
                              : duration
                                  ? static_cast<std::uint64_t>(std::llround(rate * *duration))
                                  : kept->size();
  const auto time_of = [rate](std::uint64_t n) {
    return from_seconds(static_cast<double>(n) / rate);
  };
  const Duration begin = monotonic_now();
  SendOutcome outcome;
  std::uint64_t sent = 0;
  while (sent < total && !is_stopped_()) {
    const Duration elapsed = monotonic_now() - begin;
    if (elapsed > time_of(total) + kGrace) {
      break;
    }
    const auto due = std::min(total, static_cast<std::uint64_t>(to_seconds(elapsed) * rate) + 1);
    if (due > sent) {
      outcome.latest = std::max(outcome.latest, elapsed - time_of(sent));
    }
    // Sends in batches, so that a signal or the end of the time is noticed when far behind.
    for (std::size_t i = 0; i < SinkQueue::kBatch && sent < due; ++i, ++sent) {
      const KeptDatagram& one = (*kept)[sent % kept->size()];
      RAYLOC_TRY(sinks_.queue(one.recording, sent_now(one.address, one.payload)));
    }
    RAYLOC_TRY(sinks_.flush());
    if (sent == due && sent < total) {
      sleep_until(begin + std::max(time_of(sent), elapsed + kTick));
    }
  }
  outcome.elapsed = monotonic_now() - begin;
  return outcome;
}

void RecordingSender::report_start(std::optional<Duration> time_offset) const {
  if (observer_.on_start) {
    observer_.on_start(time_offset);
  }
}

// Returns early when the sending is stopped.
void RecordingSender::sleep_until(Duration monotonic) const {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(monotonic);
  const timespec until{.tv_sec = seconds.count(), .tv_nsec = (monotonic - seconds).count()};
  while (!is_stopped_() &&
         clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace rayloc
