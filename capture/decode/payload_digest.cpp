#include "capture/decode/payload_digest.h"

#include <cstring>

namespace rayloc {

std::uint64_t payload_digest(std::span<const std::byte> bytes) {
  std::uint64_t digest = bytes.size();
  std::size_t i = 0;
  for (; i + sizeof(std::uint64_t) <= bytes.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t chunk = 0;
    std::memcpy(&chunk, bytes.data() + i, sizeof(chunk));
    digest = (digest ^ chunk) * 0x9e3779b97f4a7c15ULL;
    digest ^= digest >> 32U;
  }
  for (; i < bytes.size(); ++i) {
    digest = (digest ^ std::to_integer<std::uint64_t>(bytes[i])) * 0x9e3779b97f4a7c15ULL;
  }
  return digest;
}

}  // namespace rayloc
