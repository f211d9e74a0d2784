// Batch: the datagrams of a site that one capture node received within some
// milliseconds, and their encoding (v1::CsiBatch in proto/rayloc/v1/cluster.proto).
//
// Raw datagrams, not frames: a word of CSI is 4 bytes on the wire and 8
// to 16 as a complex number, and the decoders and their tests stay the
// reference. Timestamps are truncated to microseconds, as in recordings.
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

// Datagrams of one access point.
struct BatchPart {
  std::string access_point;
  Timestamp watermark;  // lower bound of the times of later datagrams
  DatagramRing::Piece datagrams;
};

// Batches that will not arrive: [from, to].
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

// Returns an Error for input that unseal() refuses, and for inconsistent numbers.
Expected<Batch> decode_batch(std::string_view bytes);

}  // namespace rayloc
