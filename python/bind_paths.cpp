// Paths of a link, their channel, and its derivatives.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <utility>

#include <pybind11/stl.h>

#include "engine/em/spherical.h"
#include "engine/trace/diffuse/diffuse_tracer.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raising.h"
#include "python/tracing.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

using Complexes = std::vector<std::complex<double>>;
using SharedPaths = std::shared_ptr<LinkPaths>;

// Numbers of Sionna RT's InteractionType; its 2, diffuse reflection, is not a path here
// (bind_diffuse); 16 is our addition.
constexpr std::uint8_t kNone = 0;
constexpr std::uint8_t kSpecular = 1;
constexpr std::uint8_t kRefraction = 4;
constexpr std::uint8_t kDiffraction = 8;
constexpr std::uint8_t kShadowing = 16;
constexpr std::uint32_t kNoObject = std::numeric_limits<std::uint32_t>::max();

std::uint8_t number_of(InteractionKind kind) {
  switch (kind) {
    case InteractionKind::kReflection:
      return kSpecular;
    case InteractionKind::kTransmission:
      return kRefraction;
    case InteractionKind::kShadowing:
      return kShadowing;
    case InteractionKind::kDiffraction:
      return kDiffraction;
  }
  return kNone;
}

// View of one member of every path, without a copy.
template <typename T>
py::array_t<T> path_member(const py::object& self, const T* first, const Shape& inner) {
  const auto& link = self.cast<const LinkPaths&>();
  Shape shape{size_of(link.paths.size())};
  Shape strides{sizeof(Path)};
  for (const py::ssize_t count : inner) {
    shape.push_back(count);
    strides.push_back(sizeof(T));
  }
  return view_of<T>(first, shape, strides, self);
}

py::array_t<std::complex<double>> a_of(const py::object& self) {
  const Paths& paths = self.cast<const LinkPaths&>().paths;
  static_assert(sizeof(Complex<double>) == sizeof(std::complex<double>));
  // Both are a real part followed by an imaginary part ([complex.numbers.general]).
  const auto* first =
      paths.empty() ? nullptr : reinterpret_cast<const std::complex<double>*>(&paths[0].a);
  return path_member(self, first, {});
}

py::array_t<double> tau_of(const py::object& self) {
  const Paths& paths = self.cast<const LinkPaths&>().paths;
  return path_member(self, paths.empty() ? nullptr : &paths[0].tau, {});
}

template <Vec3d Path::*kMember>
py::array_t<double> path_vectors(const py::object& self) {
  const Paths& paths = self.cast<const LinkPaths&>().paths;
  return path_member(self, paths.empty() ? nullptr : &(paths[0].*kMember).x, {3});
}

template <double (Path::*kAngle)() const>
py::array_t<double> angle_of(const LinkPaths& link) {
  std::vector<double> angles;
  angles.reserve(link.paths.size());
  for (const Path& path : link.paths) {
    angles.push_back((path.*kAngle)());
  }
  return array_of(std::move(angles), {size_of(link.paths.size())});
}

std::size_t depth_of(const LinkPaths& link) {
  std::size_t depth = 0;
  for (const Path& path : link.paths) {
    depth = std::max(depth, path.interactions.size());
  }
  return depth;
}

// [interaction][path], as in Sionna RT; `none` where a path has fewer interactions.
template <typename T, typename Get>
py::array_t<T> of_interactions(const LinkPaths& link, T none, const Get& get) {
  const std::size_t depth = depth_of(link);
  const std::size_t count = link.paths.size();
  std::vector<T> values(depth * count, none);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < link.paths[i].interactions.size(); ++k) {
      values[k * count + i] = get(link.paths[i].interactions[k]);
    }
  }
  return array_of(std::move(values), {size_of(depth), size_of(count)});
}

py::array_t<double> link_vertices(const LinkPaths& link) {
  const std::size_t depth = depth_of(link);
  const std::size_t count = link.paths.size();
  std::vector<double> values(3 * depth * count, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < link.paths[i].interactions.size(); ++k) {
      const Vec3d& place = link.paths[i].interactions[k].position;
      double* at = &values[3 * (k * count + i)];
      at[0] = place.x;
      at[1] = place.y;
      at[2] = place.z;
    }
  }
  return array_of(std::move(values), {size_of(depth), size_of(count), 3});
}

py::array_t<std::complex<double>> cfr_of(const LinkPaths& link, const OfdmGrid& grid) {
  Complexes h;
  {
    const py::gil_scoped_release unlocked;
    h = link.paths.cfr(grid);
  }
  return array_of(std::move(h), {size_of(grid.size())});
}

std::shared_ptr<LinkDerivatives> differentiate(const SharedPaths& link,
                                               const std::vector<std::string>& names) {
  const py::gil_scoped_release unlocked;
  NamedParameters wanted = parameters_of(names, *link->scene);
  PathDerivatives values =
      value_of(link->at_receiver.differentiate(link->transmitter, link->paths, wanted.parameters));
  return std::make_shared<LinkDerivatives>(
      LinkDerivatives{link, std::move(wanted.names), std::move(values)});
}

// [path][parameter]: derivatives are stored row by row.
template <typename T>
py::array_t<T> derivative_member(const py::object& self, const T* first) {
  const auto& derivatives = self.cast<const LinkDerivatives&>();
  const auto parameters = size_of(derivatives.names.size());
  const py::ssize_t step = sizeof(PathDerivatives::Derivative);
  return view_of<T>(first,
                    {size_of(derivatives.link->paths.size()), parameters},
                    {step * parameters, step},
                    self);
}

const PathDerivatives::Derivative* first_of(const py::object& self) {
  const auto& derivatives = self.cast<const LinkDerivatives&>();
  return derivatives.link->paths.empty() || derivatives.names.empty()
             ? nullptr
             : &derivatives.values.at(0, 0);
}

py::array_t<std::complex<double>> cfr_derivatives(const LinkDerivatives& derivatives,
                                                  const OfdmGrid& grid) {
  Complexes all;
  {
    const py::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < derivatives.names.size(); ++i) {
      const Complexes row = derivatives.values.cfr(derivatives.link->paths, grid, i);
      all.insert(all.end(), row.begin(), row.end());
    }
  }
  return array_of(std::move(all), {size_of(derivatives.names.size()), size_of(grid.size())});
}

using InputArray = py::array_t<std::complex<double>, py::array::c_style | py::array::forcecast>;

py::array_t<double> loss_gradient(const LinkDerivatives& derivatives,
                                  const OfdmGrid& grid,
                                  const InputArray& adjoint) {
  if (adjoint.ndim() != 1 || adjoint.shape(0) != size_of(grid.size())) {
    refuse("loss_gradient: csi_adjoint has one value a tone of the grid, " +
           std::to_string(grid.size()));
  }
  const std::span<const std::complex<double>> given(adjoint.data(), grid.size());
  if (!std::all_of(given.begin(), given.end(), [](const std::complex<double>& value) {
        return std::isfinite(value.real()) && std::isfinite(value.imag());
      })) {
    refuse("loss_gradient: csi_adjoint has a value that is not finite");
  }
  std::vector<double> gradient;
  {
    const py::gil_scoped_release unlocked;
    gradient = derivatives.values.loss_gradient(derivatives.link->paths, grid, given);
  }
  return array_of(std::move(gradient), {size_of(derivatives.names.size())});
}

std::shared_ptr<DiffuseDensity> diffuse(const LinkPaths& link, int reflections) {
  if (!link.options.diffuse) {
    refuse("Paths.diffuse: trace with diffuse_reflection=True; else all surfaces are smooth");
  }
  if (reflections < 0 || reflections > 2) {
    refuse("Paths.diffuse: reflections is from 0 to 2");
  }
  DiffuseOptions options;
  options.reflections = reflections;
  const py::gil_scoped_release unlocked;
  return std::make_shared<DiffuseDensity>(
      DiffuseTracer(link.scene, link.options, options)
          .density(link.transmitter, link.at_receiver.receiver()));
}

constexpr const char* kPathsDoc = R"(All paths of a link: fewer interactions first.

Made by `trace`. `a`, `tau`, `departure` and `arrival` are views of the memory of the engine, which
lives as long as they do; they are read-only.

    h(f) = sum a exp(-2j pi f tau), f absolute

Shapes: `a`, `tau` and the angles (paths,), `departure`, `arrival` (paths, 3), `interactions`,
    `objects` (depth, paths), `vertices` (depth, paths, 3).
Units: seconds, radians, metres; `a` is an amplitude, lambda / (4 pi length) in free space.
Frame: world, right-handed, z up; theta zenith from +z, phi azimuth from +x to +y; `_t` leaves the
    transmitter, `_r` points from the receiver towards where the wave comes from.
Errors: `derivatives` raises rayloc.Error for an unknown parameter or one without derivative.
Source: engine/trace/paths.h, engine/trace/path.h; interactions as in Sionna RT: 0 none, 1 specular,
    4 refraction, 8 diffraction, and 16 for an edge that is passed with softness.)";

constexpr const char* kDerivativesDoc = R"(Derivatives of every path of a link by every parameter.

Made by `Paths.derivatives`; the same bits as the engine gives in C++. `a` and `tau` are read-only
views of its memory.

Shapes: `a` and `tau` (paths, parameters), `cfr(grid)` (parameters, tones),
    `loss_gradient(grid, csi_adjoint)` (parameters,).
Units: unit of the value per unit of the parameter: metre, radian, S/m, or 1 for gains and eps_r.
Frame: world, right-handed, z up.
Errors: `loss_gradient` raises rayloc.Error where the adjoint is not one finite value a tone.
Source: engine/trace/path_derivatives.h, engine/trace/parameter.h.)";

void bind_link_paths(py::module_& module) {
  py::class_<LinkPaths, SharedPaths>(module, "Paths", kPathsDoc)
      .def_property_readonly(
          "a", a_of, "Coefficients without the phase of the path length, complex128.")
      .def_property_readonly("tau", tau_of, "Delays [s].")
      .def_property_readonly("departure",
                             path_vectors<&Path::departure>,
                             "Unit vectors, world: direction of the wave at the transmitter.")
      .def_property_readonly("arrival",
                             path_vectors<&Path::arrival>,
                             "Unit vectors, world: from the receiver towards the incoming wave.")
      .def_property_readonly("theta_t", angle_of<&Path::theta_t>, "Zenith of departure [rad].")
      .def_property_readonly("phi_t", angle_of<&Path::phi_t>, "Azimuth of departure [rad].")
      .def_property_readonly("theta_r", angle_of<&Path::theta_r>, "Zenith of arrival [rad].")
      .def_property_readonly("phi_r", angle_of<&Path::phi_r>, "Azimuth of arrival [rad].")
      .def_property_readonly(
          "interactions",
          [](const LinkPaths& link) {
            return of_interactions<std::uint8_t>(
                link, kNone, [](const Interaction& one) { return number_of(one.kind); });
          },
          "Kinds, (depth, paths), uint8; 0 behind the last.")
      .def_property_readonly(
          "objects",
          [](const LinkPaths& link) {
            return of_interactions<std::uint32_t>(
                link, kNoObject, [](const Interaction& one) { return one.object; });
          },
          "Places in Scene.objects, (depth, paths), uint32; 2**32 - 1 behind the last.")
      .def_property_readonly(
          "vertices", link_vertices, "Where they meet objects [m], (depth, paths, 3); else NaN.")
      .def("cfr",
           cfr_of,
           py::arg("grid"),
           "The channel at the tones of an OfdmGrid: complex128, (tones,).")
      .def("derivatives",
           differentiate,
           py::arg("parameters"),
           "Derivatives by the numbers of these names (`parameter_names`); rayloc.Error for one "
           "that the scene has not, or that has none.")
      .def("diffuse",
           diffuse,
           py::arg("reflections") = 0,
           "Echoes that rough surfaces scatter once over the same link, a DiffuseDensity, with 0 "
           "to 2 reflections before and after it in all; rayloc.Error where the paths were traced "
           "without diffuse_reflection.")
      .def("__len__", [](const LinkPaths& link) { return link.paths.size(); });
}

}  // namespace

void bind_paths(py::module_& module) {
  bind_link_paths(module);
  py::class_<LinkDerivatives, std::shared_ptr<LinkDerivatives>>(
      module, "Derivatives", kDerivativesDoc)
      .def_readonly("names", &LinkDerivatives::names, "Names of the parameters, in their order.")
      .def_property_readonly(
          "a",
          [](const py::object& self) {
            const auto* first = first_of(self);
            return derivative_member(
                self,
                first == nullptr ? nullptr
                                 : reinterpret_cast<const std::complex<double>*>(&first->a));
          },
          "d a, (paths, parameters), complex128.")
      .def_property_readonly(
          "tau",
          [](const py::object& self) {
            const auto* first = first_of(self);
            return derivative_member(self, first == nullptr ? nullptr : &first->tau);
          },
          "d tau [s], (paths, parameters).")
      .def("cfr",
           cfr_derivatives,
           py::arg("grid"),
           "Derivatives of the channel, (parameters, tones), complex128.")
      .def("loss_gradient",
           loss_gradient,
           py::arg("grid"),
           py::arg("csi_adjoint"),
           "Gradient of a real loss L, (parameters,); csi_adjoint g (tones,) has dL = Re sum "
           "conj(g) dh, so for L = sum |h|^2 it is 2 h.");
}

}  // namespace rayloc::python
