#include "engine/localize/path_grid.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "engine/base/content_hash.h"
#include "engine/base/parallel.h"
#include "engine/em/antenna_hash.h"
#include "engine/scene/scene.h"
#include "engine/scene/scene_hash.h"

namespace rayloc {
namespace {

// Increment when the meaning of the bytes changes and their size does not.
constexpr std::uint64_t kVersion = 1;
constexpr std::size_t kSamples = 24;  // number of cells traced again

static_assert(std::is_trivially_copyable_v<Ray>);

void add_count(std::string& bytes, std::uint64_t count) {
  std::array<char, sizeof(count)> raw{};
  std::memcpy(raw.data(), &count, sizeof(count));
  bytes.append(raw.data(), raw.size());
}

std::optional<std::uint64_t> take_count(std::string_view& bytes) {
  std::uint64_t count = 0;
  if (bytes.size() < sizeof(count)) {
    return std::nullopt;
  }
  std::memcpy(&count, bytes.data(), sizeof(count));
  bytes.remove_prefix(sizeof(count));
  return count;
}

template <typename T>
bool same_bits(const T& a, const T& b) {
  return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}

// Compares by member, since padding bytes are unspecified. An added member does not compile here
// until it is compared.
bool is_same_ray(const Ray& a, const Ray& b) {
  const auto& [amplitude, length, at_array, at_device, reflections, cos2_incidence, mirror] = a;
  return same_bits(amplitude, b.amplitude) && same_bits(length, b.length) &&
         same_bits(at_array, b.at_array) && same_bits(at_device, b.at_device) &&
         reflections == b.reflections && same_bits(cos2_incidence, b.cos2_incidence) &&
         same_bits(mirror, b.mirror);
}

bool are_same_rays(const std::vector<Ray>& a, const std::vector<Ray>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), is_same_ray);
}

bool is_plausible(const PathGrid& grid, const PathGridSource& source) {
  if (grid.size() != source.cells) {
    return false;
  }
  std::array<bool, kSamples> same{};
  parallel_for(kSamples, 1, [&](std::size_t i) {
    const std::size_t cell = (2 * i + 1) * source.cells / (2 * kSamples);
    same.at(i) = are_same_rays(grid[cell], source.trace(cell));
  });
  return std::all_of(same.begin(), same.end(), [](bool one) { return one; });
}

}  // namespace

std::string path_grid_key(const RoomModel& room,
                          const RoomAccessPoint& access_point,
                          const Grid& grid,
                          std::size_t most_rays) {
  ContentHash hash;
  hash.add(kVersion);
  hash.add(static_cast<std::uint64_t>(sizeof(Ray)));
  hash.add(scene_hash(*room.scene));
  for (const auto& correction : room.surface_correction) {
    hash.add(correction.real());
    hash.add(correction.imag());
  }
  hash.add(static_cast<std::uint64_t>(room.trace.max_depth));
  hash.add(static_cast<std::uint64_t>(room.trace.transmission ? 1 : 0));
  hash.add(room.trace.softness);
  hash.add(static_cast<std::uint64_t>(room.trace.candidates));
  hash.add(static_cast<std::uint64_t>(room.trace.rays));
  // Hashed only if enabled: grids stored before these options existed keep their key.
  if (room.trace.diffraction) {
    hash.add(std::string_view(room.trace.double_diffraction ? "two edges" : "an edge"));
  }
  if (room.trace.diffuse) {
    hash.add(std::string_view("diffuse"));
  }
  add_antenna(hash, room.device.pattern, room.device.polarization);
  const AntennaArray& array = access_point.array;
  hash.add(array.pose.position);
  hash.add(array.pose.orientation.yaw);
  hash.add(array.pose.orientation.pitch);
  hash.add(array.pose.orientation.roll);
  add_antenna(hash, array.pattern, array.polarization);
  hash.add(grid.first);
  hash.add(grid.step_x);
  hash.add(grid.step_y);
  hash.add(static_cast<std::uint64_t>(grid.count_x));
  hash.add(static_cast<std::uint64_t>(grid.count_y));
  hash.add(static_cast<std::uint64_t>(most_rays));
  return hash.text();
}

PathGrid make_path_grid(const PathGridSource& source,
                        const std::string& key,
                        PathGridStore* store) {
  if (store != nullptr) {
    if (const auto bytes = store->load(key)) {
      auto kept = parse_path_grid(*bytes);
      if (kept && is_plausible(*kept, source)) {
        return *std::move(kept);
      }
      store->refuse(key);
    }
  }
  PathGrid grid(source.cells);
  parallel_for(source.cells, 16, [&](std::size_t cell) { grid[cell] = source.trace(cell); });
  if (store != nullptr) {
    store->save(key, to_bytes(grid));
  }
  return grid;
}

bool is_same(const PathGrid& a, const PathGrid& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), are_same_rays);
}

// Format: number of cells, then for each cell its number of rays and the rays.
std::string to_bytes(const PathGrid& grid) {
  std::size_t size = sizeof(std::uint64_t) * (1 + grid.size());
  for (const auto& rays : grid) {
    size += rays.size() * sizeof(Ray);
  }
  std::string bytes;
  bytes.reserve(size);
  add_count(bytes, grid.size());
  for (const auto& rays : grid) {
    add_count(bytes, rays.size());
    const std::size_t end = bytes.size();
    bytes.resize(end + rays.size() * sizeof(Ray));
    if (!rays.empty()) {
      std::memcpy(bytes.data() + end, rays.data(), rays.size() * sizeof(Ray));
    }
  }
  return bytes;
}

std::optional<PathGrid> parse_path_grid(std::string_view bytes) {
  const auto cells = take_count(bytes);
  if (!cells || *cells > bytes.size() / sizeof(std::uint64_t)) {
    return std::nullopt;
  }
  PathGrid grid(*cells);
  for (auto& rays : grid) {
    const auto count = take_count(bytes);
    if (!count || *count > bytes.size() / sizeof(Ray)) {
      return std::nullopt;
    }
    rays.resize(*count);
    if (!rays.empty()) {
      std::memcpy(rays.data(), bytes.data(), rays.size() * sizeof(Ray));
    }
    bytes.remove_prefix(rays.size() * sizeof(Ray));
  }
  if (!bytes.empty()) {
    return std::nullopt;
  }
  return grid;
}

}  // namespace rayloc
