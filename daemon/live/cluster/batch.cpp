#include "daemon/live/cluster/batch.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "daemon/live/cluster/sealed_message.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {
namespace {

using std::chrono::microseconds;

constexpr std::uint32_t kLongestPayload = 65'507;          // of UDP over IPv4, RFC 768 and 791
constexpr std::int64_t kLatestUs = 9'000'000'000'000'000;  // in the year 2255: fits in nanoseconds

// The watermark of a source that has ended is the end of time.
std::int64_t to_us(Timestamp time) {
  return std::min(std::chrono::floor<microseconds>(time.time_since_epoch()).count(), kLatestUs);
}

Timestamp from_us(std::int64_t us) { return Timestamp(microseconds(us)); }

v1::DatagramAddress to_message(const DatagramAddress& address) {
  v1::DatagramAddress message;
  message.set_source_ip(address.source_ip);
  message.set_destination_ip(address.destination_ip);
  message.set_source_port(address.source_port);
  message.set_destination_port(address.destination_port);
  return message;
}

void fill_addresses(const std::vector<DatagramRing::Piece::Entry>& entries, v1::ApPart& part) {
  std::vector<DatagramAddress> known;
  for (const auto& entry : entries) {
    const auto found = std::find(known.begin(), known.end(), entry.address);
    part.add_address(static_cast<std::uint32_t>(found - known.begin()));
    if (found == known.end()) {
      known.push_back(entry.address);
      *part.add_addresses() = to_message(entry.address);
    }
  }
  if (known.size() == 1) {
    part.clear_address();
  }
}

void fill(const BatchPart& from, v1::ApPart& part) {
  part.set_access_point(from.access_point);
  part.set_watermark_us(to_us(from.watermark));
  std::int64_t before = part.watermark_us();
  for (const auto& entry : from.datagrams.entries) {
    const std::int64_t time = to_us(entry.time);
    part.add_time_delta_us(time - before);
    part.add_size(static_cast<std::uint32_t>(entry.size));
    before = time;
  }
  fill_addresses(from.datagrams.entries, part);
  const auto& payloads = from.datagrams.payloads;
  part.set_payloads(payloads.data(), payloads.size());
}

// Returns true if all its times can be represented in nanoseconds.
bool are_times(const v1::ApPart& part) {
  const auto in_range = [](std::int64_t us) { return us >= 0 && us <= kLatestUs; };
  std::int64_t time = part.watermark_us();
  return in_range(time) &&
         std::all_of(part.time_delta_us().begin(), part.time_delta_us().end(), [&](auto delta) {
           if (delta < -kLatestUs || delta > kLatestUs) {
             return false;
           }
           time += delta;
           return in_range(time);
         });
}

// Returns the inconsistency of a part; nothing where the part is valid.
std::optional<std::string> trouble_of(const v1::ApPart& part) {
  if (part.access_point().empty()) {
    return "a part without an access point";
  }
  const int count = part.time_delta_us_size();
  if (part.size_size() != count || (part.address_size() != count && part.address_size() != 0)) {
    return fmt::format("{} times, {} sizes and {} addresses, which must be as many",
                       count,
                       part.size_size(),
                       part.address_size());
  }
  if (count > 0 && part.addresses().empty()) {
    return "datagrams without an address";
  }
  if (!are_times(part)) {
    return "times before 1970 or after 2255";
  }
  std::uint64_t bytes = 0;
  for (const std::uint32_t size : part.size()) {
    if (size > kLongestPayload) {
      return fmt::format(
          "a datagram of {} bytes, and none has more than {}", size, kLongestPayload);
    }
    bytes += size;
  }
  if (bytes != part.payloads().size()) {
    return fmt::format(
        "sizes that add up to {} bytes, and {} bytes", bytes, part.payloads().size());
  }
  for (const std::uint32_t address : part.address()) {
    if (address >= static_cast<std::uint32_t>(part.addresses_size())) {
      return fmt::format("address {} of {}", address, part.addresses_size());
    }
  }
  for (const v1::DatagramAddress& address : part.addresses()) {
    if (std::max(address.source_port(), address.destination_port()) >
        std::numeric_limits<std::uint16_t>::max()) {
      return "a port above 65535";
    }
  }
  return std::nullopt;
}

std::optional<std::string> trouble_of(const v1::CsiBatch& batch) {
  if (batch.epoch() == 0 || batch.number() == 0) {
    return "it has no number";
  }
  std::uint64_t after = 0;
  for (const v1::GapMark& gap : batch.gaps()) {
    if (gap.from_number() <= after || gap.to_number() < gap.from_number() ||
        gap.to_number() >= batch.number()) {
      return fmt::format("a gap of numbers {} to {}", gap.from_number(), gap.to_number());
    }
    after = gap.to_number();
  }
  for (const v1::ApPart& part : batch.parts()) {
    if (const auto trouble = trouble_of(part)) {
      return "access point '" + part.access_point() + "': " + *trouble;
    }
  }
  return std::nullopt;
}

DatagramAddress from_message(const v1::DatagramAddress& message) {
  return {message.source_ip(),
          message.destination_ip(),
          static_cast<std::uint16_t>(message.source_port()),
          static_cast<std::uint16_t>(message.destination_port())};
}

// REQUIRES: no trouble_of(part).
BatchPart from_message(const v1::ApPart& part) {
  BatchPart to;
  to.access_point = part.access_point();
  to.watermark = from_us(part.watermark_us());
  std::vector<DatagramAddress> addresses;
  addresses.reserve(static_cast<std::size_t>(part.addresses_size()));
  for (const v1::DatagramAddress& address : part.addresses()) {
    addresses.push_back(from_message(address));
  }
  auto& entries = to.datagrams.entries;
  entries.reserve(static_cast<std::size_t>(part.size_size()));
  std::int64_t time = part.watermark_us();
  for (int i = 0; i < part.size_size(); ++i) {
    time += part.time_delta_us(i);
    const std::size_t address = part.address().empty() ? 0 : part.address(i);
    entries.push_back({from_us(time), addresses.at(address), part.size(i)});
  }
  const std::span<const char> bytes = part.payloads();
  const auto all = std::as_bytes(bytes);
  to.datagrams.payloads.assign(all.begin(), all.end());
  return to;
}

}  // namespace

std::string encode(const Batch& batch) {
  v1::CsiBatch message;
  message.set_epoch(batch.epoch);
  message.set_number(batch.number);
  message.set_oldest_kept(batch.oldest_kept);
  message.set_clock_synchronised(batch.clock_synchronised);
  for (const BatchPart& part : batch.parts) {
    fill(part, *message.add_parts());
  }
  for (const BatchGap& gap : batch.gaps) {
    v1::GapMark& mark = *message.add_gaps();
    mark.set_from_number(gap.from);
    mark.set_to_number(gap.to);
    mark.set_reason(gap.reason);
    mark.mutable_datagrams()->insert(gap.datagrams.begin(), gap.datagrams.end());
  }
  return seal(message);
}

Expected<Batch> decode_batch(std::string_view bytes) {
  v1::CsiBatch message;
  RAYLOC_TRY(unseal(bytes, message));
  if (const auto trouble = trouble_of(message)) {
    return bad_input(fmt::format("batch {}: {}", message.number(), *trouble));
  }
  Batch batch;
  batch.epoch = message.epoch();
  batch.number = message.number();
  batch.oldest_kept = message.oldest_kept();
  batch.clock_synchronised = message.clock_synchronised();
  batch.parts.reserve(static_cast<std::size_t>(message.parts_size()));
  for (const v1::ApPart& part : message.parts()) {
    batch.parts.push_back(from_message(part));
  }
  for (const v1::GapMark& mark : message.gaps()) {
    batch.gaps.push_back({mark.from_number(),
                          mark.to_number(),
                          {mark.datagrams().begin(), mark.datagrams().end()},
                          mark.reason()});
  }
  return batch;
}

}  // namespace rayloc
