#include "daemon/live/cluster/ownership/claim_rule.h"

#include <algorithm>
#include <string_view>
#include <tuple>

namespace rayloc {
namespace {

// Constants of FNV-1a, 64 bits.
constexpr std::uint64_t kOffset = 0xcbf29ce484222325;
constexpr std::uint64_t kPrime = 0x100000001b3;
// Constants of the finalizer of MurmurHash3, which spreads names that differ in the last letter.
constexpr std::uint64_t kMix1 = 0xff51afd7ed558ccd;
constexpr std::uint64_t kMix2 = 0xc4ceb9fe1a85ec53;
constexpr unsigned kShift = 33;
// Load relative to the mean above which others take precedence, in percent:
// loads are then nearly even and few sites deviate from their first choice.
constexpr std::size_t kShare = 115;

std::uint64_t hash_of(std::string_view worker, std::string_view site) {
  std::uint64_t hash = kOffset;
  for (const std::string_view text : {worker, std::string_view("\n"), site}) {
    for (const char c : text) {
      hash = (hash ^ static_cast<unsigned char>(c)) * kPrime;
    }
  }
  hash = (hash ^ (hash >> kShift)) * kMix1;
  hash = (hash ^ (hash >> kShift)) * kMix2;
  return hash ^ (hash >> kShift);
}

}  // namespace

bool is_full(const Candidate& candidate) {
  return candidate.capacity > 0 && candidate.sites >= candidate.capacity;
}

std::size_t rank_of(const std::string& worker,
                    const std::string& site,
                    std::size_t all_sites,
                    const std::vector<Candidate>& candidates) {
  const std::size_t share =
      (all_sites * kShare / 100 + candidates.size()) / std::max<std::size_t>(1, candidates.size());
  // Lower values come first.
  const auto place = [&](const Candidate& one) {
    return std::tuple(
        !one.stands_by, one.is_behind, one.sites >= share, ~hash_of(one.worker, site));
  };
  const auto own = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& one) {
    return one.worker == worker;
  });
  if (own == candidates.end()) {
    return candidates.size();
  }
  return static_cast<std::size_t>(
      std::count_if(candidates.begin(), candidates.end(), [&](const Candidate& one) {
        return !is_full(one) && place(one) < place(*own);
      }));
}

}  // namespace rayloc
