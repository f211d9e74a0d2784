// Number of paths in a set of snapshots, from the eigenvalues of its covariance.
//
// References: [SF] M. Kotaru et al., SpotFi, SIGCOMM 2015. [WK] M. Wax, T. Kailath, IEEE Trans.
// ASSP 33 (1985) 387.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace rayloc {

enum class PathCountRule {
  kDrop,  // up to the last large drop from one eigenvalue to the next
  kMdl,   // minimum description length [WK]
};

// The names used in settings, in the order of the rules.
std::span<const std::string_view> path_count_rule_names();

inline constexpr std::size_t kFewestPaths = 2;  // a count, lower limit
inline constexpr std::size_t kMaxPaths = 5;     // a count, of a room [SF]

// From kFewestPaths to kMaxPaths. `eigenvalues`: descending, not negative; `snapshots`: number of
// snapshots in the covariance.
std::size_t count_paths(std::span<const double> eigenvalues,
                        std::size_t snapshots,
                        PathCountRule rule = PathCountRule::kDrop);

}  // namespace rayloc
