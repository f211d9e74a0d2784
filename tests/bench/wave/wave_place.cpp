#include "tests/bench/wave/wave_place.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include "engine/base/constants.h"
#include "engine/room/surface_correction.h"
#include "engine/scene/scene.h"
#include "engine/trace/interactions/interaction.h"

namespace rayloc::bench {
namespace {

TraceOptions one_deeper(TraceOptions options) {
  ++options.max_depth;
  return options;
}

using Value = std::complex<double>;

constexpr std::size_t kMaxEdges = 64;  // a count, chosen: rays over an edge that are kept
constexpr double kRoughness = 0.3;     // S, chosen: the power is fitted, so that only 0 is not 0.3
constexpr double kTolerance = 0.03;    // of a density's power, chosen: likelihoods resolve less

// The surfaces that a path meets, from the transmitter on.
using PathKey = std::vector<std::tuple<InteractionKind, std::uint32_t, std::uint32_t>>;

PathKey key_of(const Path& path) {
  PathKey key;
  key.reserve(path.interactions.size());
  for (const Interaction& one : path.interactions) {
    key.emplace_back(one.kind, one.surface, one.edge);
  }
  return key;
}

bool bends(const Path& path) {
  return std::any_of(path.interactions.begin(),
                     path.interactions.end(),
                     [](const Interaction& one) { return is_edge(one.kind); });
}

Vec3d unit(const Vec3d& v) { return (1.0 / norm(v)) * v; }

// A face or an edge moved by s lengthens the way by |in - out| s, of a reflection 2 s cos.
Ray edge_ray(const Path& path, const RoomModel& room, const Vec3d& device, const Vec3d& array) {
  Ray ray;
  ray.amplitude = apply_surface_correction(room.surface_correction, path, {path.a.re, path.a.im});
  ray.length = path.tau * kSpeedOfLight;
  ray.at_array = path.arrival;
  ray.at_device = path.departure;
  for (std::size_t i = 0; i < path.interactions.size(); ++i) {
    const Interaction& one = path.interactions[i];
    if (one.kind == InteractionKind::kTransmission) {
      continue;
    }
    const Vec3d before = i == 0 ? device : path.interactions[i - 1].position;
    const Vec3d after =
        i + 1 == path.interactions.size() ? array : path.interactions[i + 1].position;
    const Vec3d turn = unit(one.position - before) - unit(after - one.position);
    ++ray.reflections;
    ray.cos2_incidence += 0.25 * dot(turn, turn);
  }
  return ray;
}

// Everything but metal and glass is as rough as everything else.
std::shared_ptr<const Scene> roughened(const Scene& scene) {
  std::vector<RadioMaterial> materials = scene.materials();
  for (RadioMaterial& material : materials) {
    const bool smooth = material.name.find("metal") != std::string::npos ||
                        material.name.find("glass") != std::string::npos;
    material.scattering = {};
    material.scattering.scattering_coefficient = smooth ? 0.0 : kRoughness;
  }
  return std::make_shared<const Scene>(
      *Scene::create({scene.objects(), std::move(materials), scene.carrier_hz()}));
}

}  // namespace

WaveTracer::WaveTracer(const RoomModel& room,
                       const RoomAccessPoint& access_point,
                       const WaveOptions& options)
    : room_(room),
      access_point_(access_point),
      offsets_(offsets_of(access_point.array)),
      tracer_(PathTracer(room.scene, room.trace).at(array_origin<Receiver>(access_point.array))),
      deeper_(PathTracer(room.scene, one_deeper(room.trace))
                  .at(array_origin<Receiver>(access_point.array))) {
  if (options.edges) {
    TraceOptions over = room.trace;
    over.diffraction = true;
    const PathTracer edges(room.scene, over);
    edge_centre_ = std::make_unique<const ReceiverTracer>(
        edges.at(array_origin<Receiver>(access_point.array)));
    edge_array_ = std::make_unique<const ArrayTracer>(edges, access_point.array);
  }
  const auto rough = options.densities > 0 ? roughened(*room.scene) : nullptr;
  for (std::size_t i = 0; i < options.densities; ++i) {
    diffuse_.emplace_back(
        rough,
        room.trace,
        DiffuseOptions{.reflections = static_cast<int>(i), .tolerance = kTolerance});
  }
}

std::vector<EdgeRay> WaveTracer::deeper_to(const Transmitter& device,
                                           const WavePlace& place) const {
  std::vector<EdgeRay> deeper;
  for (const Ray& ray :
       rays_of(deeper_.trace(device), room_, device.position, kMaxRays + kMaxEdges)) {
    const bool is_known = std::any_of(place.rays.begin(), place.rays.end(), [&](const Ray& known) {
      return known.length == ray.length && known.amplitude == ray.amplitude;
    });
    if (is_known) {
      continue;
    }
    EdgeRay& added = deeper.emplace_back(EdgeRay{ray, {}, {}});
    for (const Vec3d& offset : offsets_) {
      added.factor.emplace_back(1.0);
      added.longer.push_back(norm(ray.length * ray.at_array - offset) - ray.length);
    }
  }
  return deeper;
}

Transmitter WaveTracer::transmitter_at(const Vec3d& device) const {
  return {{device, {}, room_.device.pattern, room_.device.polarization}};
}

std::vector<Value> WaveTracer::edge_recording(const Vec3d& device) const {
  std::vector<Paths> paths = edge_array_->trace(transmitter_at(device));
  for (Paths& one : paths) {
    correct_paths(room_.surface_correction, one);
  }
  return array_csi(paths, room_.grid);
}

WavePlace WaveTracer::trace(const Vec3d& device) const {
  const Transmitter transmitter = transmitter_at(device);
  WavePlace place;
  place.rays = rays_of(tracer_.trace(transmitter), room_, device, kMaxRays);
  if (place.rays.empty()) {
    return place;
  }
  place.deeper = deeper_to(transmitter, place);
  if (edge_centre_ != nullptr) {
    place.edges = edges_to(transmitter);
  }
  const auto receiver = array_origin<Receiver>(access_point_.array);
  for (std::size_t i = 0; i < diffuse_.size(); ++i) {
    place.density.at(i) = bins_of(diffuse_[i].density(transmitter, receiver), place);
  }
  return place;
}

std::vector<EdgeRay> WaveTracer::edges_to(const Transmitter& device) const {
  std::vector<std::map<PathKey, const Path*>> received;
  const std::vector<Paths> elements = edge_array_->trace(device);
  for (const Paths& paths : elements) {
    auto& one = received.emplace_back();
    for (const Path& path : paths) {
      if (bends(path)) {
        one.emplace(key_of(path), &path);
      }
    }
  }
  std::vector<EdgeRay> edges;
  for (const Path& path : edge_centre_->trace(device)) {
    if (!bends(path)) {
      continue;
    }
    EdgeRay edge{edge_ray(path, room_, device.position, access_point_.array.pose.position), {}, {}};
    for (const auto& one : received) {
      const auto found = one.find(key_of(path));
      const bool is_received = found != one.end();
      edge.factor.push_back(is_received ? Value(found->second->a.re, found->second->a.im) /
                                              Value(path.a.re, path.a.im)
                                        : Value());
      edge.longer.push_back(is_received ? (found->second->tau - path.tau) * kSpeedOfLight : 0.0);
    }
    edges.push_back(std::move(edge));
  }
  std::stable_sort(edges.begin(), edges.end(), [](const EdgeRay& a, const EdgeRay& b) {
    return std::norm(a.ray.amplitude) > std::norm(b.ray.amplitude);
  });
  if (edges.size() > kMaxEdges) {
    edges.resize(kMaxEdges);
  }
  return edges;
}

DensityBins WaveTracer::bins_of(const DiffuseDensity& density, const WavePlace& place) const {
  const std::size_t antennas = offsets_.size();
  const double k = 2.0 * std::numbers::pi * room_.grid.centre_hz / kSpeedOfLight;
  double traced = 0.0;
  double first = place.rays.front().length;
  for (const Ray& ray : place.rays) {
    traced += std::norm(ray.amplitude);
    first = std::min(first, ray.length);
  }
  DensityBins bins{std::vector<Value>(kBins * antennas * antennas), density.power() / traced};
  if (!(density.power() > 0.0)) {
    return bins;
  }
  const double power = density.power();
  std::vector<Value> steering(antennas);
  for (const DiffuseEcho& echo : density.echoes()) {
    const double late = (echo.tau - first / kSpeedOfLight) / kBin;
    if (late >= static_cast<double>(kBins)) {
      continue;
    }
    const auto bin = static_cast<std::size_t>(std::max(late, 0.0));
    // The last leg is a sphere about the patch, and about as curved after a reflection.
    const double away = norm(echo.patch.position - access_point_.array.pose.position);
    for (std::size_t m = 0; m < antennas; ++m) {
      steering[m] = std::polar(1.0, -k * (norm(away * echo.arrival - offsets_[m]) - away));
    }
    for (std::size_t m = 0; m < antennas; ++m) {
      for (std::size_t n = 0; n < antennas; ++n) {
        bins.covariance[(bin * antennas + m) * antennas + n] +=
            echo.power / power * steering[m] * std::conj(steering[n]);
      }
    }
  }
  return bins;
}

std::vector<Value> WaveTracer::edge_csi(const WavePlace& place,
                                        std::span<const double> known,
                                        double first_length) const {
  const OfdmGrid& grid = room_.grid;
  std::vector<Value> h(offsets_.size() * grid.size());
  for (std::size_t e = 0; e < place.edges.size(); ++e) {
    const EdgeRay& edge = place.edges[e];
    for (std::size_t m = 0; m < offsets_.size(); ++m) {
      const double delay = (edge.ray.length + edge.longer[m] - first_length) / kSpeedOfLight;
      for (std::size_t t = 0; t < grid.size(); ++t) {
        h[m * grid.size() + t] +=
            known[e] * edge.ray.amplitude * edge.factor[m] *
            std::polar(1.0, -2.0 * std::numbers::pi * grid.frequency_hz(t) * delay);
      }
    }
  }
  return h;
}

}  // namespace rayloc::bench
