// The header that rayloc-capture puts before each datagram: an accepted one is written back as the
// same bytes, and has a time that durations can be added to; a short one is refused.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "capture/transport/relayed_datagram.h"
#include "engine/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  const auto header = rayloc::decode_relay_header(bytes);
  if (!header) {
    return 0;
  }
  RAYLOC_CHECK(size >= rayloc::kRelayHeaderBytes);
  const auto again = rayloc::encode_relay_header(*header);
  RAYLOC_CHECK(std::equal(again.begin(), again.end(), bytes.begin()));
  for (const rayloc::Timestamp time : {header->time, header->watermark}) {
    RAYLOC_CHECK(time >= rayloc::Timestamp{} && time + std::chrono::hours(24 * 365) > time);
  }
  return 0;
}
