// The receiver under any sequence of datagrams. Input: a byte of options, then records of
//
//   2 bytes  milliseconds since the record before, signed, little-endian
//   2 bytes  length n of the payload, little-endian
//   n bytes  payload
//
// After every push each datagram must be in exactly one counter, and every frame well formed.
#include <algorithm>
#include <cstring>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

void check_counters(const CsiReceiverCounters& counters, std::size_t max_pending) {
  std::uint64_t rejected = 0;
  for (const auto& [reason, count] : counters.rejected) {
    rejected += count;
  }
  RAYLOC_CHECK(counters.received == rejected + counters.duplicates + counters.late +
                                        counters.in_frames + counters.in_flight);
  RAYLOC_CHECK(counters.partial <= counters.frames);
  // 16 slots of at most 32 blocks of tones.
  RAYLOC_CHECK(counters.in_flight <= max_pending * 16 * 32);
}

void check_frames(std::vector<CsiFrame>& frames, bool raw) {
  for (const CsiFrame& frame : frames) {
    RAYLOC_CHECK(!frame.rx_chains.empty() && frame.csi.antennas() == frame.rx_chains.size());
    RAYLOC_CHECK(frame.csi.streams() >= 1 && frame.csi.streams() <= 4);
    RAYLOC_CHECK(frame.csi.tones() == frame.tone_index.size() && frame.csi.tones() > 0);
    RAYLOC_CHECK(frame.power_dbm.size() == frame.rx_chains.size());
    RAYLOC_CHECK(frame.time <= frame.time_last);
    RAYLOC_CHECK(frame.bandwidth_mhz <= frame.channel_bandwidth_mhz);
    RAYLOC_CHECK(raw || std::is_sorted(frame.tone_index.begin(), frame.tone_index.end()));
  }
  frames.clear();
}

void run(std::span<const std::uint8_t> input) {
  CsiReceiverOptions options;
  options.raw = (input[0] & 1U) != 0;
  options.max_pending = 1U + (input[0] >> 4U);
  if ((input[0] & 2U) != 0) {
    options.expected_rx_chains = {0, 2};
  }
  CsiReceiver receiver(options);
  std::vector<CsiFrame> frames;
  Timestamp now(std::chrono::hours(1));
  for (std::size_t at = 1; at + 4 <= input.size();) {
    std::int16_t milliseconds = 0;
    std::uint16_t length = 0;
    std::memcpy(&milliseconds, input.data() + at, sizeof(milliseconds));
    std::memcpy(&length, input.data() + at + 2, sizeof(length));
    at += 4;
    const auto payload = input.subspan(at, std::min<std::size_t>(length, input.size() - at));
    now += std::chrono::milliseconds(milliseconds);
    receiver.push({now, {}, std::as_bytes(payload)}, frames);
    check_counters(receiver.counters(), options.max_pending);
    check_frames(frames, options.raw);
    at += payload.size();
  }
  receiver.flush(frames);
  check_frames(frames, options.raw);
  const CsiReceiverCounters counters = receiver.counters();
  check_counters(counters, options.max_pending);
  RAYLOC_CHECK(counters.in_flight == 0);
}

}  // namespace
}  // namespace rayloc

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) {
    rayloc::run({data, size});
  }
  return 0;
}
