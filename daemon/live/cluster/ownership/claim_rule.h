// Rule that selects the worker for a site without an owner: every worker computes the same
// ranking, from the states that it receives of the others, so that as a rule one alone claims it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rayloc {

struct Candidate {
  std::string worker;
  std::size_t sites = 0;     // number of sites that it has
  std::size_t capacity = 0;  // 0: any number
  bool stands_by = false;    // it is a standby for that site
  bool is_behind = false;    // it leaves data out of a site that it has
};

// Number of candidates that precede `worker` for that site; full candidates do not count.
// The standby for it comes first, and workers that are behind come last. Those with more
// than their share of `all_sites` follow the others; ties are broken by rendezvous
// hashing, so that the sites of a failed worker spread evenly over all others.
std::size_t rank_of(const std::string& worker,
                    const std::string& site,
                    std::size_t all_sites,
                    const std::vector<Candidate>& candidates);

bool is_full(const Candidate& candidate);

}  // namespace rayloc
