// A digest of bytes that distinguishes two CSI payloads. Not for security.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rayloc {

std::uint64_t payload_digest(std::span<const std::byte> bytes);

}  // namespace rayloc
