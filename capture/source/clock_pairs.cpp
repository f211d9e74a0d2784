#include "capture/source/clock_pairs.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace rayloc {
namespace {

using Size = Duration::rep;

// Both ends are included.
struct SizeRange {
  Size from = 0;
  Size to = 0;
};

// Sizes of the opposite sign that undo `size` to within `gap`; zero counts as forward.
SizeRange undoing(Size size, Size gap) {
  constexpr Size kLeast = std::numeric_limits<Size>::min();
  constexpr Size kMost = std::numeric_limits<Size>::max();
  const Size opposite = size == kLeast ? kMost : -size;
  const Size from = opposite < kLeast + gap ? kLeast : opposite - gap;
  const Size to = opposite > kMost - gap ? kMost : opposite + gap;
  return size < 0 ? SizeRange{std::max<Size>(from, 0), to}
                  : SizeRange{from, std::min<Size>(to, -1)};
}

// Finds the latest jump so far whose size is in a range: a tree of maxima over all sizes in
// order.
class LatestBySize {
 public:
  explicit LatestBySize(const std::vector<ClockJump>& jumps) {
    for (const ClockJump& jump : jumps) {
      sizes_.push_back(jump.size().count());
    }
    std::sort(sizes_.begin(), sizes_.end());
    sizes_.erase(std::unique(sizes_.begin(), sizes_.end()), sizes_.end());
    latest_.resize(2 * sizes_.size());
  }

  // `number`: of the jump, from 1 on, in order.
  void add(Size size, std::size_t number) {
    for (std::size_t node = position(size) + sizes_.size(); node > 0; node /= 2) {
      latest_[node] = number;
      ++steps_;
    }
  }

  // Returns 0 if there is none.
  std::size_t find(SizeRange range) {
    std::size_t begin = position(range.from) + sizes_.size();
    const auto after = std::upper_bound(sizes_.begin(), sizes_.end(), range.to);
    std::size_t end = static_cast<std::size_t>(after - sizes_.begin()) + sizes_.size();
    std::size_t latest = 0;
    for (; begin < end; begin /= 2, end /= 2) {
      if (begin % 2 == 1) {
        latest = std::max(latest, latest_[begin++]);
      }
      if (end % 2 == 1) {
        latest = std::max(latest, latest_[--end]);
      }
      ++steps_;
    }
    return latest;
  }

  std::uint64_t steps() const { return steps_; }

 private:
  std::size_t position(Size size) const {
    return static_cast<std::size_t>(std::lower_bound(sizes_.begin(), sizes_.end(), size) -
                                    sizes_.begin());
  }

  std::vector<Size> sizes_;          // in order, each once
  std::vector<std::size_t> latest_;  // latest jump of each node; the leaves are the second half
  std::uint64_t steps_ = 0;
};

}  // namespace

std::uint64_t mark_clocks_set(std::vector<ClockJump>& jumps, Duration gap) {
  LatestBySize latest(jumps);
  for (std::size_t i = 0; i < jumps.size(); ++i) {
    const Size size = jumps[i].size().count();
    const std::size_t undone = latest.find(undoing(size, gap.count()));
    if (undone > 0) {
      jumps[undone - 1].was_set = true;
    }
    jumps[i].was_set = jumps[i].was_set || size < 0 || undone > 0;
    latest.add(size, i + 1);
  }
  return latest.steps();
}

}  // namespace rayloc
