// Recordings for tests: datagrams read from a file, or synthesised.
//
// Reads classic little-endian Ethernet pcap files, gzip'd or not; shares no code with
// capture/source/pcap_source, so that decoders are tested without it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/transport/datagram.h"

namespace rayloc::test {

struct RecordedDatagram {
  Timestamp time;
  std::vector<std::byte> payload;

  Datagram view() const { return {time, {}, payload}; }
};
using Recording = std::vector<RecordedDatagram>;

// The file's bytes, uncompressed. Throws std::runtime_error when it cannot be read.
std::vector<std::byte> read_bytes(const std::string& path);

// The datagrams of a file.
Recording read_recording(const std::string& path);

// Passes everything through one receiver, flushed at the end. Checks the conservation law after
// every push (a GoogleTest failure if it does not hold).
std::vector<CsiFrame> receive_all(CsiReceiver& receiver, const Recording& recording);

// received = sum(rejected) + duplicates + late + in_frames + in_flight.
void expect_conservation(const CsiReceiverCounters& counters);

}  // namespace rayloc::test
