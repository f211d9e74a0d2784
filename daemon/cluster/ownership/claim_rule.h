// Who is to take a site that nobody has: every worker computes the same, from what it hears of the
// others, so that as a rule one alone claims it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rayloc {

struct Candidate {
  std::string worker;
  std::size_t sites = 0;     // that it has
  std::size_t capacity = 0;  // 0: any number
  bool stands_by = false;    // it computes along for that site
  bool is_behind = false;    // it leaves something out of a site that it has
};

// How many of the candidates come before `worker` for that site; nothing of those that are full.
// Who stands by for it comes first, and who is behind last. Those with more than their share of
// `all_sites` come behind the others; among equals rendezvous hashing decides, so that a worker
// that dies leaves its sites to all others alike.
std::size_t rank_of(const std::string& worker,
                    const std::string& site,
                    std::size_t all_sites,
                    const std::vector<Candidate>& candidates);

bool is_full(const Candidate& candidate);

}  // namespace rayloc
