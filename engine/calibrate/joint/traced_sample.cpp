#include "engine/calibrate/joint/traced_sample.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/room/surface_correction.h"
#include "engine/trace/array_tracer.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

// The tracer's parameters, in the order of the columns of its derivatives.
struct Columns {
  explicit Columns(const Scene& scene)
      : surfaces(scene.surfaces().size()), materials(scene.materials().size()) {
    for (std::uint32_t s = 0; s < surfaces; ++s) {
      parameters.push_back(Parameter::surface_offset(s));
    }
    for (std::uint32_t m = 0; m < materials; ++m) {
      parameters.push_back(Parameter::relative_permittivity(m));
      parameters.push_back(Parameter::conductivity(m));
      parameters.push_back(Parameter::thickness(m));
    }
    for (int axis = 0; axis < 3; ++axis) {
      parameters.push_back(Parameter::receiver_position(axis));
    }
    for (int axis = 0; axis < 3; ++axis) {
      parameters.push_back(Parameter::receiver_array_turn(axis));
    }
    for (int axis = 0; axis < 3; ++axis) {
      parameters.push_back(Parameter::transmitter_position(axis));
    }
  }
  std::size_t material(std::size_t m) const { return surfaces + 3 * m; }
  std::size_t position() const { return surfaces + 3 * materials; }
  std::size_t turn() const { return position() + 3; }
  std::size_t survey() const { return position() + 6; }

  std::size_t surfaces;
  std::size_t materials;
  std::vector<Parameter> parameters;
};

// The relevant paths, so that only these are differentiated.
Paths strong(const Paths& paths) {
  const auto power_of = [](const Path& path) {
    return path.a.re * path.a.re + path.a.im * path.a.im;
  };
  double power = 0.0;
  for (const Path& path : paths) {
    power += power_of(path);
  }
  std::vector<Path> kept;
  std::copy_if(paths.begin(), paths.end(), std::back_inserter(kept), [&](const Path& path) {
    return power_of(path) > kNegligible * power;
  });
  return Paths(std::move(kept));
}

class SampleBuilder {
 public:
  SampleBuilder(const RoomModel& room,
                const RoomUnknowns& unknowns,
                const Columns& columns,
                const SampleSite& site)
      : room_(room),
        unknowns_(unknowns),
        columns_(columns),
        array_(room.access_points[site.access_point].array) {
    sample_.point = site.point;
    sample_.access_point = site.access_point;
    sample_.coupling = unknowns.coupling(site.access_point);
  }

  void add_antenna(const Paths& paths, const PathDerivatives& derivatives) {
    const std::size_t antenna = sample_.rays.size();
    auto& rays = sample_.rays.emplace_back();
    for (std::size_t p = 0; p < paths.size(); ++p) {
      rays.push_back(ray_of(paths[p], p, derivatives, antenna));
    }
  }

  TracedSample take() { return std::move(sample_); }

 private:
  LinearRay ray_of(const Path& path,
                   std::size_t p,
                   const PathDerivatives& derivatives,
                   std::size_t antenna) {
    LinearRay ray;
    ray.amplitude = {path.a.re, path.a.im};
    ray.delay = path.tau;
    ray.first_term = static_cast<std::uint32_t>(sample_.terms.size());
    const auto at = [&](std::size_t column) -> const PathDerivatives::Derivative& {
      return derivatives.at(p, column);
    };
    for (std::uint32_t s = 0; s < columns_.surfaces; ++s) {
      if (at(s).tau != 0.0) {
        add_delay(ray, unknowns_.surface_offset(s), at(s).tau);
      }
    }
    for (const Interaction& interaction : path.interactions) {
      if (is_corrected(interaction.kind)) {
        add_log(ray, unknowns_.surface_gain(interaction.surface), 1.0);
        add_log(ray, unknowns_.surface_phase(interaction.surface), Value(0.0, 1.0));
      }
    }
    add_materials(ray, at);
    add_array(ray, at, antenna);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ray.survey.at(axis) = at(columns_.survey() + axis).tau;
    }
    ray.end_term = static_cast<std::uint32_t>(sample_.terms.size());
    return ray;
  }

  template <typename At>
  void add_materials(const LinearRay& ray, const At& at) {
    for (std::uint32_t m = 0; m < columns_.materials; ++m) {
      const RadioMaterial& material = room_.scene->materials()[m];
      const std::array<double, 3> value{
          material.relative_permittivity, material.conductivity, material.thickness};
      for (std::uint32_t part = 0; part < 3; ++part) {
        const auto& a = at(columns_.material(m) + part).a;
        if ((a.re != 0.0 || a.im != 0.0) && std::isfinite(value.at(part))) {
          add_log(ray,
                  unknowns_.permittivity(m) + part,
                  value.at(part) * Value(a.re, a.im) / ray.amplitude);
        }
      }
    }
  }

  template <typename At>
  void add_array(const LinearRay& ray, const At& at, std::size_t antenna) {
    const std::size_t ap = sample_.access_point;
    const Vec3d along = rotation(array_.pose.orientation) * Vec3d{0.0, 1.0, 0.0};
    const Vec3d slope{at(columns_.position()).tau,
                      at(columns_.position() + 1).tau,
                      at(columns_.position() + 2).tau};
    const std::uint32_t position = unknowns_.array_position(ap);
    add_delay(ray, position, slope.x);
    add_delay(ray, position + 1, slope.y);
    add_delay(ray, position + 2, slope.z);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      add_delay(ray, unknowns_.array_angle(ap) + axis, at(columns_.turn() + axis).tau);
    }
    add_delay(ray, unknowns_.element_position(ap, antenna), dot(slope, along));
    if (antenna > 0) {
      add_log(ray, unknowns_.chain_gain(ap, antenna), 1.0);
      add_log(ray, unknowns_.chain_gain(ap, antenna) + 1, Value(0.0, 1.0));
    }
  }

  // Terms of the same unknown are merged: a path may meet a surface twice.
  RayTerm& term(const LinearRay& ray, std::uint32_t unknown) {
    const auto first = sample_.terms.begin() + static_cast<std::ptrdiff_t>(ray.first_term);
    const auto found = std::find_if(
        first, sample_.terms.end(), [&](const RayTerm& one) { return one.unknown == unknown; });
    return found != sample_.terms.end() ? *found
                                        : sample_.terms.emplace_back(RayTerm{unknown, 0.0, {}});
  }
  void add_delay(const LinearRay& ray, std::uint32_t unknown, double delay) {
    term(ray, unknown).delay += delay;
  }
  void add_log(const LinearRay& ray, std::uint32_t unknown, const Value& log_amplitude) {
    term(ray, unknown).log_amplitude += log_amplitude;
  }

  const RoomModel& room_;
  const RoomUnknowns& unknowns_;
  const Columns& columns_;
  const AntennaArray& array_;
  TracedSample sample_;
};

}  // namespace

Expected<std::vector<TracedSample>> trace_samples(const RoomModel& room,
                                                  const RoomUnknowns& unknowns,
                                                  std::span<const SampleSite> sites,
                                                  const TraceOptions& options) {
  const PathTracer tracer(room.scene, options);
  const Columns columns(*room.scene);
  std::vector<ArrayTracer> arrays;
  for (const RoomAccessPoint& ap : room.access_points) {
    arrays.emplace_back(tracer, ap.array);
  }
  std::vector<TracedSample> samples(sites.size());
  std::vector<Expected<void>> outcome(sites.size());
  parallel_for(sites.size(), 1, [&](std::size_t i) {
    const ArrayTracer& array = arrays[sites[i].access_point];
    const Transmitter device{
        {sites[i].position, {}, room.device.pattern, room.device.polarization}};
    auto paths = array.trace(device);
    for (Paths& one : paths) {
      one = strong(one);
    }
    const auto derivatives = array.differentiate(device, paths, columns.parameters);
    if (!derivatives) {
      outcome[i] = tl::make_unexpected(derivatives.error());
      return;
    }
    SampleBuilder builder(room, unknowns, columns, sites[i]);
    for (std::size_t e = 0; e < paths.size(); ++e) {
      builder.add_antenna(paths[e], (*derivatives)[e]);
    }
    samples[i] = builder.take();
  });
  for (auto& one : outcome) {
    RAYLOC_TRY(one);
  }
  return samples;
}

}  // namespace rayloc
