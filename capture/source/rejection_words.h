// Advice on packets that were rejected: the capture or network that causes them, by reason.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "capture/transport/datagram_source.h"

namespace rayloc {

struct RejectionAdvice {
  std::string what;  // follows the number of packets: "packets are ..."
  std::string advice;
};

// Advice for a reason that is a fault of the capture or the network; empty texts for all others.
RejectionAdvice rejection_advice(std::string_view reason);

// True if the share of packets is high enough that the access point probably sent them.
bool is_notable(std::uint64_t packets, std::uint64_t received);

// Advice on `rejected` among so many packets.
std::vector<std::string> rejection_words(const std::map<std::string, std::uint64_t>& rejected,
                                         std::uint64_t received,
                                         const std::string& name);

// Advice on a file, pipe or interface that was read, a line each; `name` is the source's.
std::vector<std::string> rejection_words(const SourceCounters& counters, const std::string& name);

}  // namespace rayloc
