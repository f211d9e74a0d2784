// What to do about packets that were rejected: which capture or network they come from, by reason.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "capture/transport/datagram_source.h"

namespace rayloc {

struct RejectionAdvice {
  std::string what;  // follows their number: "packets are ..."
  std::string advice;
};

// Of a reason that is a fault of the capture or the network; empty texts for all others.
RejectionAdvice rejection_advice(std::string_view reason);

// Enough of all packets to be the access point's, and not another program's.
bool is_notable(std::uint64_t packets, std::uint64_t received);

// Of `rejected` among so many packets.
std::vector<std::string> rejection_words(const std::map<std::string, std::uint64_t>& rejected,
                                         std::uint64_t received,
                                         const std::string& name);

// Of a file, pipe or interface that was read, a line each; `name` is the source's.
std::vector<std::string> rejection_words(const SourceCounters& counters, const std::string& name);

}  // namespace rayloc
