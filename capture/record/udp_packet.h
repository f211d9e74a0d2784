// Sizes and numbers of a UDP packet over IPv4.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rayloc {

inline constexpr std::size_t kIpv4HeaderBytes = 20;  // without options
inline constexpr std::size_t kUdpHeaderBytes = 8;
inline constexpr std::uint8_t kProtocolUdp = 17;

}  // namespace rayloc
