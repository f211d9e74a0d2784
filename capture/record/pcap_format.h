// The bytes of a recording: a classic pcap (microseconds, Ethernet) with generated Ethernet, IPv4
// and UDP headers around each datagram, equal to those of the access point's firmware.
#pragma once

#include <cstddef>
#include <vector>

#include "capture/transport/datagram.h"

namespace rayloc {

// The longest payload that fits into UDP over IPv4.
constexpr std::size_t kMaxRecordedPayload = 65535 - 20 - 8;

std::vector<std::byte> pcap_file_header();

// Appends the record, its time truncated to microseconds. Returns false if the time is out of
// range: classic pcap has 32 bits of seconds since 1970. REQUIRES: payload <= kMaxRecordedPayload.
bool append_pcap_record(const Datagram& datagram, std::vector<std::byte>& out);

}  // namespace rayloc
