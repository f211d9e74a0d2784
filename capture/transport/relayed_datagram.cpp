#include "capture/transport/relayed_datagram.h"

#include "capture/transport/byte_reader.h"

namespace rayloc {
namespace {

constexpr std::uint32_t kMagic = 0x31434c52;  // "RLC1"
// Leaves room for every duration that is added to a time.
constexpr Timestamp kLatest{std::chrono::sys_days(std::chrono::year(2200) / 1 / 1)};

class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::byte> bytes) : bytes_(bytes) {}

  void put(std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      bytes_[at_++] = static_cast<std::byte>(value >> (8 * i));
    }
  }
  void put(Timestamp time) { put(static_cast<std::uint64_t>(time.time_since_epoch().count()), 8); }

 private:
  std::span<std::byte> bytes_;
  std::size_t at_ = 0;
};

// Empty outside the supported range.
std::optional<Timestamp> time_at(const ByteReader& reader, std::size_t offset) {
  const std::uint64_t nanoseconds = reader.u64(offset);
  if (nanoseconds > static_cast<std::uint64_t>(kLatest.time_since_epoch().count())) {
    return std::nullopt;
  }
  return Timestamp(Duration(static_cast<std::int64_t>(nanoseconds)));
}

}  // namespace

std::array<std::byte, kRelayHeaderBytes> encode_relay_header(const RelayHeader& header) {
  std::array<std::byte, kRelayHeaderBytes> bytes{};
  ByteWriter writer(bytes);
  writer.put(kMagic, 4);
  writer.put(static_cast<std::uint32_t>(header.kind), 4);
  writer.put(header.epoch, 8);
  writer.put(header.sequence, 8);
  writer.put(header.time);
  writer.put(header.watermark);
  writer.put(header.kernel_drops, 8);
  writer.put(header.rejected, 8);
  writer.put(header.address.source_ip, 4);
  writer.put(header.address.destination_ip, 4);
  writer.put(header.address.source_port, 2);
  writer.put(header.address.destination_port, 2);
  return bytes;
}

std::optional<RelayHeader> decode_relay_header(std::span<const std::byte> bytes) {
  const ByteReader reader(bytes);
  if (reader.size() < kRelayHeaderBytes || reader.u32(0) != kMagic || reader.u32(4) > 1) {
    return std::nullopt;
  }
  const std::optional<Timestamp> time = time_at(reader, 24);
  const std::optional<Timestamp> watermark = time_at(reader, 32);
  if (!time || !watermark) {
    return std::nullopt;
  }
  RelayHeader header;
  header.kind = static_cast<RelayHeader::Kind>(reader.u32(4));
  header.epoch = reader.u64(8);
  header.sequence = reader.u64(16);
  header.time = *time;
  header.watermark = *watermark;
  header.kernel_drops = reader.u64(40);
  header.rejected = reader.u64(48);
  header.address.source_ip = reader.u32(56);
  header.address.destination_ip = reader.u32(60);
  header.address.source_port = reader.u16(64);
  header.address.destination_port = reader.u16(66);
  return header;
}

}  // namespace rayloc
