// What both capture fuzzers do: parse the bytes as one window and again in pieces, as a pipe brings
// them, and check what must hold for any input.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "capture/pcap_packet.h"
#include "capture/pcap_parser.h"

namespace rayloc::fuzz {

struct Parsed {
  std::vector<std::size_t> payloads;  // sizes, in order
  std::size_t packets = 0;
  std::size_t consumed = 0;
  std::string error;

  friend bool operator==(const Parsed&, const Parsed&) = default;
};

// Gives the parser `piece` more bytes whenever it asks for some.
inline Parsed parse(std::span<const std::byte> file, std::size_t piece) {
  Parsed parsed;
  pcap::PcapParser parser;
  std::size_t end = 0;
  while (true) {
    // A copy of exact size: AddressSanitizer sees any read past the window.
    const std::vector<std::byte> window(file.begin() + static_cast<std::ptrdiff_t>(parsed.consumed),
                                        file.begin() + static_cast<std::ptrdiff_t>(end));
    const pcap::PcapParser::Step step = parser.next(window);
    if (step.status == pcap::PcapParser::Status::kError) {
      parsed.error = step.error;
      return parsed;
    }
    if (step.status == pcap::PcapParser::Status::kNeedMore) {
      if (end == file.size()) {
        return parsed;
      }
      end += std::min(piece, file.size() - end);
      continue;
    }
    if (step.size == 0 || step.size > window.size()) {
      std::abort();  // no progress, or more than there was
    }
    if (step.status == pcap::PcapParser::Status::kPacket) {
      ++parsed.packets;
      const auto datagram = pcap::udp_datagram(step.packet, std::nullopt);
      if (datagram) {
        parsed.payloads.push_back(datagram->payload.size());
        // Touch the bytes: they must be inside the window.
        for (const std::byte b : datagram->payload) {
          parsed.payloads.back() += std::to_integer<std::size_t>(b) & 1U;
        }
      }
    }
    parsed.consumed += step.size;
  }
}

inline int parse_capture(std::span<const std::uint8_t> magic, std::span<const std::uint8_t> input) {
  std::vector<std::byte> file(std::max(magic.size(), input.size()));
  std::transform(input.begin(), input.end(), file.begin(), [](auto b) { return std::byte{b}; });
  std::transform(magic.begin(), magic.end(), file.begin(), [](auto b) { return std::byte{b}; });
  constexpr std::size_t kMaxBytes = 8192;  // longer inputs find nothing new, slowly
  file.resize(std::min(file.size(), kMaxBytes));
  const Parsed whole = parse(file, file.size());
  const Parsed pieces = parse(file, 61);
  if (!(whole == pieces)) {
    std::abort();  // what a pipe brings must not depend on how it comes
  }
  return 0;
}

}  // namespace rayloc::fuzz
