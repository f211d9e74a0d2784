// The part that both capture fuzzers share: parses the bytes at once and in pieces, as from a pipe,
// judges the time stamps of their records, and checks the properties that hold for any input.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "capture/record/pcap_packet.h"
#include "capture/record/pcap_parser.h"
#include "capture/source/record_times.h"

namespace rayloc::fuzz {

struct Parsed {
  std::vector<std::size_t> payloads;  // sizes, in order
  std::vector<Timestamp> stamps;      // of the same
  std::size_t packets = 0;
  std::size_t consumed = 0;
  std::string error;

  friend bool operator==(const Parsed&, const Parsed&) = default;
};

// Gives the parser `piece` more bytes whenever it asks for some.
inline Parsed parse(std::span<const std::byte> file, std::size_t piece) {
  Parsed parsed;
  pcap::PcapParser parser;
  std::size_t end = 0;
  while (true) {
    // A copy of exact size: AddressSanitizer sees any read past the window.
    const std::vector<std::byte> window(file.begin() + static_cast<std::ptrdiff_t>(parsed.consumed),
                                        file.begin() + static_cast<std::ptrdiff_t>(end));
    const pcap::PcapParser::Step step = parser.next(window);
    if (step.status == pcap::PcapParser::Status::kError) {
      parsed.error = step.error;
      return parsed;
    }
    if (step.status == pcap::PcapParser::Status::kNeedMore) {
      if (end == file.size()) {
        return parsed;
      }
      end += std::min(piece, file.size() - end);
      continue;
    }
    if (step.size == 0 || step.size > window.size()) {
      std::abort();  // no progress, or more than there was
    }
    if (step.status == pcap::PcapParser::Status::kPacket) {
      ++parsed.packets;
      const auto datagram = pcap::udp_datagram(step.packet, std::nullopt);
      if (datagram) {
        parsed.payloads.push_back(datagram->payload.size());
        parsed.stamps.push_back(datagram->time);
        // Touch the bytes: they must be inside the window.
        for (const std::byte b : datagram->payload) {
          parsed.payloads.back() += std::to_integer<std::size_t>(b) & 1U;
        }
      }
    }
    parsed.consumed += step.size;
  }
}

// A look through a file, and what becomes of its records then.
inline void judge_stamps(const std::vector<Timestamp>& stamps, bool as_stamped) {
  const StampLimits limits;
  StampJudge judge(limits, as_stamped);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    judge.add({i + 1, 24 + 16 * i}, stamps[i]);
  }
  const RecordTimes times = judge.finish();
  const auto damaged = std::accumulate(
      times.damaged.begin(), times.damaged.end(), std::uint64_t{0}, [](auto sum, const auto& one) {
        return sum + one.records;
      });
  RecordClock clock(times);
  std::uint64_t refused = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto time = clock.event_time(i + 1, stamps[i]);
    refused += time ? 0U : 1U;
    const bool is_reported =
        !time || std::any_of(times.busy.begin(), times.busy.end(), [&](const auto& s) {
          return s.begin <= *time && *time <= s.end;
        });
    if (!is_reported) {
      std::abort();  // a record outside of the times that have records
    }
  }
  if (refused != damaged || stamps.empty() != times.busy.empty()) {
    std::abort();
  }
  if (describe(times, "file", limits.gap).size() > 10) {
    std::abort();  // too many lines for a reader
  }
}

// As of a pipe: each record is given, refused or held, and none is lost.
inline void judge_stream(const std::vector<Timestamp>& stamps) {
  using Ruling = StreamClock::Ruling;
  StreamClock clock(StampLimits{}, false);
  std::size_t given = 0;
  std::size_t dropped = 0;
  bool held = false;
  for (const Timestamp stamp : stamps) {
    Ruling ruling = clock.scan(stamp);
    if (ruling == Ruling::kGiveHeld) {
      given += held ? 1U : 0U;
      held = false;
      ruling = clock.scan(stamp);
    }
    if (ruling == Ruling::kDropHeld) {
      dropped += held ? 1U : 0U;
      held = false;
      ruling = Ruling::kGive;
    }
    if (held || ruling == Ruling::kGiveHeld) {
      std::abort();  // a second one before the first was ruled on
    }
    held = ruling == Ruling::kHold;
    given += held ? 0U : 1U;
    static_cast<void>(clock.event_time(stamp));
  }
  (clock.give_at_end() ? given : dropped) += held ? 1U : 0U;
  if (given + dropped != stamps.size()) {
    std::abort();
  }
}

inline int parse_capture(std::span<const std::uint8_t> magic, std::span<const std::uint8_t> input) {
  std::vector<std::byte> file(std::max(magic.size(), input.size()));
  std::transform(input.begin(), input.end(), file.begin(), [](auto b) { return std::byte{b}; });
  std::transform(magic.begin(), magic.end(), file.begin(), [](auto b) { return std::byte{b}; });
  constexpr std::size_t kMaxBytes = 8192;  // longer inputs find nothing new, slowly
  file.resize(std::min(file.size(), kMaxBytes));
  const Parsed whole = parse(file, file.size());
  const Parsed pieces = parse(file, 61);
  if (!(whole == pieces)) {
    std::abort();  // what a pipe brings must not depend on how it comes
  }
  judge_stamps(whole.stamps, false);
  judge_stamps(whole.stamps, true);
  judge_stream(whole.stamps);
  return 0;
}

}  // namespace rayloc::fuzz
