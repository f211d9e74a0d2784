#include "engine/scene/solid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace rayloc {
namespace {

// A ratio to the largest volume of a face with the mesh's first corner: above rounding, far below
// a sheet of metal.
constexpr double kMinVolume = 1e-12;

// For each vertex of the mesh the number of its position.
std::vector<std::uint32_t> weld(const Mesh& mesh) {
  std::map<std::tuple<double, double, double>, std::uint32_t> places;
  std::vector<std::uint32_t> place;
  place.reserve(mesh.vertices.size());
  for (const Vec3d& v : mesh.vertices) {
    const auto next = static_cast<std::uint32_t>(places.size());
    place.push_back(places.try_emplace({v.x, v.y, v.z}, next).first->second);
  }
  return place;
}

bool is_closed(const Mesh& mesh, const std::vector<std::uint32_t>& place) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = place[t[i]];
      const std::uint32_t to = place[t[(i + 1) % 3]];
      balance[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
    }
  }
  return std::all_of(
      balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

// Disjoint sets of positions that triangles connect.
class Components {
 public:
  explicit Components(std::size_t places) : parent_(places) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t place) {
    while (parent_[place] != place) {
      parent_[place] = parent_[parent_[place]];
      place = parent_[place];
    }
    return place;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

Solid classify_solid(const Mesh& mesh) {
  const std::vector<std::uint32_t> place = weld(mesh);
  if (mesh.triangles.empty() || !is_closed(mesh, place)) {
    return {};
  }
  Components components(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    components.join(place[t[0]], place[t[1]]);
    components.join(place[t[1]], place[t[2]]);
  }
  const Vec3d& reference = mesh.vertices[mesh.triangles[0][0]];
  std::map<std::uint32_t, double> volume;
  double largest = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]] - reference;
    const Vec3d b = mesh.vertices[t[1]] - reference;
    const Vec3d c = mesh.vertices[t[2]] - reference;
    const double part = dot(a, cross(b, c));
    volume[components.find(place[t[0]])] += part;
    largest = std::max(largest, std::abs(part));
  }
  // Faces drawn from both sides enclose only rounding errors.
  const double least = kMinVolume * largest;
  const auto outwards = [&](const auto& shell) { return shell.second > least; };
  const auto inwards = [&](const auto& shell) { return shell.second < -least; };
  const int shells = static_cast<int>(volume.size());
  if (std::all_of(volume.begin(), volume.end(), outwards)) {
    return {shells, 1};
  }
  if (std::all_of(volume.begin(), volume.end(), inwards)) {
    return {shells, -1};
  }
  return {};
}

// Solid angles of the triangles: Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983).
double winding_number(const Mesh& mesh, const Vec3d& point) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]] - point;
    const Vec3d b = mesh.vertices[t[1]] - point;
    const Vec3d c = mesh.vertices[t[2]] - point;
    const double na = norm(a);
    const double nb = norm(b);
    const double nc = norm(c);
    sum += std::atan2(dot(a, cross(b, c)),
                      na * nb * nc + dot(a, b) * nc + dot(b, c) * na + dot(c, a) * nb);
  }
  return sum / (2.0 * std::numbers::pi);
}

bool is_inside(const Mesh& mesh, const Vec3d& point) {
  return std::abs(winding_number(mesh, point)) > 0.5;
}

}  // namespace rayloc
