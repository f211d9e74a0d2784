#include "tests/support/recording.h"

#include <zlib.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

namespace rayloc::test {
namespace {

constexpr std::size_t kFileHeader = 24;
constexpr std::size_t kRecordHeader = 16;
constexpr std::size_t kEthernetHeader = 14;
constexpr std::size_t kUdpHeader = 8;

std::uint32_t u32_at(const std::vector<std::byte>& bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

}  // namespace

std::vector<std::byte> read_bytes(const std::string& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (file == nullptr) {
    throw std::runtime_error("cannot open " + path);
  }
  std::vector<std::byte> bytes;
  std::array<std::byte, 65536> chunk{};
  int count = 0;
  while ((count = gzread(file.get(), chunk.data(), chunk.size())) > 0) {
    bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + count);
  }
  if (count < 0) {
    throw std::runtime_error("cannot read " + path);
  }
  return bytes;
}

Recording read_recording(const std::string& path) {
  const auto file = read_bytes(path);
  Recording recording;
  for (std::size_t at = kFileHeader; at + kRecordHeader <= file.size();) {
    const auto seconds = std::chrono::seconds(u32_at(file, at));
    const auto microseconds = std::chrono::microseconds(u32_at(file, at + 4));
    const std::size_t length = u32_at(file, at + 8);
    const std::size_t packet = at + kRecordHeader;
    if (packet + length > file.size()) {
      throw std::runtime_error(path + ": torn record");
    }
    const std::size_t ip_header =
        4 * std::to_integer<std::size_t>(file[packet + kEthernetHeader] & std::byte{0xf});
    const std::size_t udp = packet + kEthernetHeader + ip_header;
    const std::size_t udp_length = std::to_integer<std::size_t>(file[udp + 4]) << 8U |
                                   std::to_integer<std::size_t>(file[udp + 5]);
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(udp);
    recording.push_back({Timestamp(seconds + microseconds),
                         {begin + static_cast<std::ptrdiff_t>(kUdpHeader),
                          begin + static_cast<std::ptrdiff_t>(udp_length)}});
    at = packet + length;
  }
  return recording;
}

void expect_conservation(const CsiReceiverCounters& counters) {
  std::uint64_t rejected = 0;
  for (const auto& [reason, count] : counters.rejected) {
    rejected += count;
  }
  EXPECT_EQ(
      counters.received,
      rejected + counters.duplicates + counters.late + counters.in_frames + counters.in_flight);
}

std::vector<CsiFrame> receive_all(CsiReceiver& receiver, const Recording& recording) {
  std::vector<CsiFrame> frames;
  std::uint64_t pushed = receiver.counters().received;
  for (const RecordedDatagram& datagram : recording) {
    receiver.push(datagram.view(), frames);
    ++pushed;
    const CsiReceiverCounters counters = receiver.counters();
    EXPECT_EQ(counters.received, pushed);
    expect_conservation(counters);
  }
  receiver.flush(frames);
  expect_conservation(receiver.counters());
  EXPECT_EQ(receiver.counters().in_flight, 0U);
  return frames;
}

}  // namespace rayloc::test
