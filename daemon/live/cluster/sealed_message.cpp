#include "daemon/live/cluster/sealed_message.h"

#include <google/protobuf/message_lite.h>
#include <zlib.h>

#include <array>

#include <fmt/format.h>

namespace rayloc {
namespace {

constexpr std::string_view kMark = "RLC";
constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kSealBytes = 8;  // mark, version, checksum
constexpr std::size_t kSumAt = 4;

std::uint32_t sum_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void put_sum(std::uint32_t sum, char* to) {
  for (int i = 0; i < 4; ++i) {
    to[i] = static_cast<char>(static_cast<std::uint8_t>(sum >> (8 * i)));
  }
}

std::uint32_t sum_at(const char* from) {
  std::uint32_t sum = 0;
  for (int i = 0; i < 4; ++i) {
    sum |= std::uint32_t{static_cast<std::uint8_t>(from[i])} << (8 * i);
  }
  return sum;
}

}  // namespace

std::string seal(const google::protobuf::MessageLite& message) {
  std::string bytes(kMark);
  bytes += static_cast<char>(kVersion);
  bytes.resize(kSealBytes);
  message.AppendToString(&bytes);
  put_sum(sum_of(std::string_view(bytes).substr(kSealBytes)), bytes.data() + kSumAt);
  return bytes;
}

Expected<void> unseal(std::string_view bytes, google::protobuf::MessageLite& message) {
  if (bytes.size() < kSealBytes || bytes.substr(0, kMark.size()) != kMark) {
    return bad_input(fmt::format("{} bytes that are no message of a cluster", bytes.size()));
  }
  const auto version = static_cast<std::uint8_t>(bytes[kMark.size()]);
  if (version != kVersion) {
    return bad_input(fmt::format(
        "a message of version {}, and this program reads version {}: run the same version of "
        "raylocd on every machine of the cluster",
        version,
        kVersion));
  }
  const std::string_view body = bytes.substr(kSealBytes);
  if (sum_at(bytes.data() + kSumAt) != sum_of(body)) {
    return bad_input("a message that has changed on its way: its checksum does not hold");
  }
  if (!message.ParseFromArray(body.data(), static_cast<int>(body.size()))) {
    return bad_input("a message of another kind: it is no " + message.GetTypeName());
  }
  return {};
}

}  // namespace rayloc
