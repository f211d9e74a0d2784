// The message of rayloc-capture to raylocd for every captured datagram: one datagram of an AF_UNIX
// socket, this header and then the payload. Little-endian.
//
//   0  4  "RLC1"
//   4  4  kind: 0 a captured datagram, 1 a tick, which has no payload
//   8  8  epoch: distinguishes one run of the sender from the next
//  16  8  sequence: number of datagrams captured earlier in this run, sent or not
//  24  8  time: arrival of the datagram [ns since 1970]; of a tick the watermark
//  32  8  watermark: nothing older follows [ns since 1970]
//  40  8  packets that the kernel dropped in this run
//  48  8  packets that passed the filter in this run and hold no datagram
//  56  4  source address, 60 4 destination address, 64 2 source port, 66 2 destination port
//  68     payload
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "capture/transport/datagram.h"

namespace rayloc {

constexpr std::size_t kRelayHeaderBytes = 68;

struct RelayHeader {
  enum class Kind : std::uint32_t { kDatagram, kTick };
  Kind kind = Kind::kDatagram;
  std::uint64_t epoch = 0;
  std::uint64_t sequence = 0;
  Timestamp time{};
  Timestamp watermark{};
  std::uint64_t kernel_drops = 0;
  std::uint64_t rejected = 0;
  DatagramAddress address;
};

std::array<std::byte, kRelayHeaderBytes> encode_relay_header(const RelayHeader& header);

// Empty if the bytes are no such header: too short, another kind, times before 1970 or after
// 2200.
std::optional<RelayHeader> decode_relay_header(std::span<const std::byte> bytes);

}  // namespace rayloc
