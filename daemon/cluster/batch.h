// Batch: what one capture node heard of a site in some milliseconds, and how it travels
// (v1::CsiBatch in proto/rayloc/v1/cluster.proto).
//
// Raw datagrams, not frames: a word of CSI is 4 bytes on the wire and 8 to 16 as a complex number,
// and the decoders and their tests stay the truth. Stamps are truncated to microseconds, as
// recordings are.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/pipeline/record/datagram_ring.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Of one access point.
struct BatchPart {
  std::string access_point;
  Timestamp watermark;  // none that comes later is older
  DatagramRing::Piece datagrams;
};

// Batches that do not come: [from, to].
struct BatchGap {
  std::uint64_t from = 0;
  std::uint64_t to = 0;
  std::map<std::string, std::uint64_t> datagrams;  // by access point
  std::string reason;
};

struct Batch {
  std::uint64_t epoch = 0;   // of the node's start
  std::uint64_t number = 0;  // from 1
  std::vector<BatchPart> parts;
  std::vector<BatchGap> gaps;  // of lower numbers, ascending
  std::uint64_t oldest_kept = 0;
  bool clock_synchronised = false;
};

std::string encode(const Batch& batch);

// An Error for what unseal() refuses, and for numbers that contradict each other.
Expected<Batch> decode_batch(std::string_view bytes);

}  // namespace rayloc
