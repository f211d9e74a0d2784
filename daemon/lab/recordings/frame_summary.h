// FrameSummary: the outcome of all datagrams of recordings.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "capture/assemble/csi_receiver.h"
#include "capture/transport/datagram_source.h"

namespace rayloc {

// datagrams = decoded + sum(rejected).
struct FrameSummary {
  std::uint64_t datagrams = 0;
  std::uint64_t decoded = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t late = 0;
  std::uint64_t frames = 0;
  std::uint64_t partial = 0;
  std::uint64_t unrecorded = 0;  // from gap marks in the recordings; not part of datagrams
  std::map<std::string, std::uint64_t> rejected;

  void add(const SourceCounters& source, const CsiReceiverCounters& receiver);
};

// One object {"summary": {...}}, without newline.
std::string summary_json(const FrameSummary& summary);

// For people, without newline.
std::string summary_text(const FrameSummary& summary);

}  // namespace rayloc
