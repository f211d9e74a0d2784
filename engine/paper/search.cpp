#include "engine/paper/search.h"

#include <algorithm>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"

namespace rayloc::paper {
namespace {

std::mt19937_64 random_of(std::uint64_t seed, Timestamp time, std::size_t start) {
  const auto ticks = static_cast<std::uint64_t>(time.time_since_epoch().count());
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32U); };
  std::seed_seq seeds{low(seed), high(seed), low(ticks), high(ticks), low(start), high(start)};
  return std::mt19937_64(seeds);
}

}  // namespace

PlanBounds plan_bounds(const RoomModel& room, double margin) {
  const auto inside = [margin](double least, double most) {
    const double off = std::min(margin, 0.5 * (most - least));
    return std::pair(least + off, most - off);
  };
  const auto [min_x, max_x] = inside(room.bounds_min.x, room.bounds_max.x);
  const auto [min_y, max_y] = inside(room.bounds_min.y, room.bounds_max.y);
  return {{min_x, min_y, room.bounds_min.z}, {max_x, max_y, room.bounds_max.z}};
}

End search(const std::function<LossInPlan(const Vec3d&)>& loss,
           const Search& from,
           const LocalizerOptions& options) {
  const PlanBounds& bounds = from.bounds;
  std::vector<End> ends(options.starts);
  parallel_for(ends.size(), 1, [&](std::size_t i) {
    std::mt19937_64 random = random_of(from.seed, from.time, i);
    std::uniform_real_distribution<double> along_x(bounds.min.x, bounds.max.x);
    std::uniform_real_distribution<double> along_y(bounds.min.y, bounds.max.y);
    const double x = along_x(random);
    const double y = along_y(random);
    Vec3d start{x, y, from.height};
    if (i == 0 && options.start) {
      start = {options.start->x, options.start->y, from.height};
    }
    const Vec3d end = descend(loss, start, bounds, options.descent, random).position;
    ends[i] = {end, loss(end).value};
  });
  return *std::min_element(
      ends.begin(), ends.end(), [](const auto& a, const auto& b) { return a.loss < b.loss; });
}

LossInPlan centre_loss(const RoomModel& room, double weight, const Vec3d& position) {
  const double x = position.x - 0.5 * (room.bounds_min.x + room.bounds_max.x);
  const double y = position.y - 0.5 * (room.bounds_min.y + room.bounds_max.y);
  return {weight * (x * x + y * y), 2.0 * weight * x, 2.0 * weight * y};
}

}  // namespace rayloc::paper
