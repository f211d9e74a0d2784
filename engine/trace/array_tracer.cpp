#include "engine/trace/array_tracer.h"

#include <optional>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/base/parallel.h"

namespace rayloc {
namespace {

// The same paths at an element with that offset from the traced point.
Paths as_plane_waves(const Paths& paths, const Vec3d& offset) {
  std::vector<Path> moved;
  moved.reserve(paths.size());
  for (const Path& path : paths) {
    moved.push_back(path);
    moved.back().tau -= dot(path.arrival, offset) / kSpeedOfLight;
  }
  return Paths(std::move(moved));
}

}  // namespace

ArrayTracer::ArrayTracer(const PathTracer& tracer, const AntennaArray& array, ArrayMode mode)
    : array_(array), mode_(mode) {
  if (mode == ArrayMode::kPlaneWave) {
    tracers_.push_back(tracer.at(array_origin<Receiver>(array)));
    return;
  }
  tracers_ = tracer.at(array_elements<Receiver>(array));
}

std::vector<Paths> ArrayTracer::trace(const Transmitter& transmitter) const {
  std::vector<Paths> paths(element_count());
  if (mode_ == ArrayMode::kPlaneWave) {
    const Paths at_origin = tracers_.front().trace(transmitter);
    const Mat3d world_from_array = rotation(array_.pose.orientation);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      paths[i] = as_plane_waves(at_origin, world_from_array * array_.element_offset[i]);
    }
    return paths;
  }
  const auto lit = tracers_.front().lit_by(transmitter);
  parallel_for(paths.size(), 1, [&](std::size_t i) {
    paths[i] = tracers_[i].trace(transmitter, lit.get());
  });
  return paths;
}

Expected<std::vector<PathDerivatives>> ArrayTracer::differentiate(
    const Transmitter& transmitter,
    std::span<const Paths> paths,
    std::span<const Parameter> parameters) const {
  RAYLOC_CHECK(paths.size() == element_count());
  if (mode_ == ArrayMode::kPlaneWave) {
    return make_error(ErrorKind::kUsage,
                      "no derivatives of paths taken as plane waves; trace element by element");
  }
  std::vector<std::optional<Expected<PathDerivatives>>> found(paths.size());
  parallel_for(paths.size(), 1, [&](std::size_t i) {
    found[i] = tracers_[i].differentiate(transmitter, paths[i], parameters);
  });
  std::vector<PathDerivatives> derivatives;
  for (auto& one : found) {
    if (!one->has_value()) {
      return tl::make_unexpected(one->error());
    }
    derivatives.push_back(std::move(**one));
  }
  return derivatives;
}

std::vector<std::complex<double>> array_csi(std::span<const Paths> paths, const OfdmGrid& grid) {
  std::vector<std::complex<double>> h(paths.size() * grid.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    paths[i].cfr(grid, std::span(h).subspan(i * grid.size(), grid.size()));
  }
  return h;
}

std::vector<double> array_loss_gradient(std::span<const PathDerivatives> derivatives,
                                        std::span<const Paths> paths,
                                        const OfdmGrid& grid,
                                        std::span<const std::complex<double>> csi_adjoint) {
  RAYLOC_CHECK(derivatives.size() == paths.size() &&
               csi_adjoint.size() == paths.size() * grid.size());
  std::vector<double> sum;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::vector<double> part = derivatives[i].loss_gradient(
        paths[i], grid, csi_adjoint.subspan(i * grid.size(), grid.size()));
    sum.resize(part.size(), 0.0);
    for (std::size_t j = 0; j < part.size(); ++j) {
      sum[j] += part[j];
    }
  }
  return sum;
}

}  // namespace rayloc
