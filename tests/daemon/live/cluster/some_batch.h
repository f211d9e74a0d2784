// Batches for tests: every datagram is another one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "daemon/live/cluster/batch.h"

namespace rayloc {

inline constexpr std::uint64_t kSomeEpoch = 77;

// `counts`: the number of datagrams of each access point. Their content follows from `number`.
inline Batch some_batch(std::uint64_t number,
                        const std::vector<std::pair<std::string, std::size_t>>& counts = {},
                        std::uint64_t epoch = kSomeEpoch) {
  constexpr std::size_t kShortest = 20;
  Batch batch;
  batch.epoch = epoch;
  batch.number = number;
  const Timestamp begin{std::chrono::milliseconds(1'700'000'000'000 + 20 * number)};
  for (const auto& [access_point, count] : counts) {
    BatchPart& part = batch.parts.emplace_back();
    part.access_point = access_point;
    part.watermark = begin;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t size = kShortest + i;
      part.watermark = begin + i * std::chrono::microseconds(100);
      part.datagrams.entries.push_back({part.watermark, {}, size});
      part.datagrams.payloads.insert(
          part.datagrams.payloads.end(), size, std::byte{static_cast<std::uint8_t>(number + i)});
    }
  }
  return batch;
}

}  // namespace rayloc
