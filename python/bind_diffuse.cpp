// Diffuse scattering of rough surfaces over a link: power by delay and angles.
#include <vector>

#include <pybind11/stl.h>

#include "engine/trace/diffuse/diffuse_density.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raising.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

constexpr const char* kDensityDoc =
    R"(Echoes that the rough surfaces of a scene scatter over a link, once.

Made by `Paths.diffuse`. An echo represents a part of a surface. Its power is the mean of |h|^2 over
all phases that the part may have, so there is no amplitude: echoes have no place in `cfr`. `tau`,
`power`, `departure`, `arrival` and `vertices` are read-only views of the memory of the engine.

Shapes: `tau` and `power` (echoes,), `departure`, `arrival` and `vertices` (echoes, 3),
    `profile(...)` (bins,).
Units: seconds, metres; powers are received over sent, of the same kind as |Paths.a|^2.
Frame: world, right-handed, z up; `arrival` points from the receiver towards the incoming wave.
Errors: `profile` raises rayloc.Error where step is not above 0 or bins are not 1 to 1,000,000.
Source: engine/trace/diffuse/diffuse_density.h.)";

// View of one member of every echo, without a copy.
template <typename T>
py::array_t<T> echo_member(const py::object& self, const T DiffuseEcho::*which) {
  const auto& echoes = self.cast<const DiffuseDensity&>().echoes();
  return view_of<T>(echoes.empty() ? nullptr : &(echoes.front().*which),
                    {size_of(echoes.size())},
                    {sizeof(DiffuseEcho)},
                    self);
}

template <typename Get>
py::array_t<double> vectors(const py::object& self, const Get& get) {
  const auto& echoes = self.cast<const DiffuseDensity&>().echoes();
  return view_of<double>(echoes.empty() ? nullptr : &get(echoes.front()).x,
                         {size_of(echoes.size()), 3},
                         {sizeof(DiffuseEcho), sizeof(double)},
                         self);
}

py::array_t<double> profile(const DiffuseDensity& density, double first, double step, int bins) {
  constexpr int kMaxBins = 1'000'000;  // a count, chosen: 8 MB
  if (!(step > 0.0) || bins < 1 || bins > kMaxBins) {
    refuse("DiffuseDensity.profile: step is above 0 [s], bins from 1 to 1,000,000");
  }
  return array_of(density.profile(first, step, static_cast<std::size_t>(bins)), {bins});
}

}  // namespace

void bind_diffuse(py::module_& module) {
  py::class_<DiffuseDensity, std::shared_ptr<DiffuseDensity>>(module, "DiffuseDensity", kDensityDoc)
      .def_property_readonly(
          "tau",
          [](const py::object& self) { return echo_member(self, &DiffuseEcho::tau); },
          "Delays [s].")
      .def_property_readonly(
          "power",
          [](const py::object& self) { return echo_member(self, &DiffuseEcho::power); },
          "Mean of |h|^2 of each echo.")
      .def_property_readonly(
          "departure",
          [](const py::object& self) {
            return vectors(self,
                           [](const DiffuseEcho& one) -> const Vec3d& { return one.departure; });
          },
          "Unit vectors, world: the way the wave leaves the transmitter.")
      .def_property_readonly(
          "arrival",
          [](const py::object& self) {
            return vectors(self,
                           [](const DiffuseEcho& one) -> const Vec3d& { return one.arrival; });
          },
          "Unit vectors, world: from the receiver to where the wave comes from.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return vectors(
                self, [](const DiffuseEcho& one) -> const Vec3d& { return one.patch.position; });
          },
          "Where they are scattered [m], world.")
      .def_property_readonly("total_power", &DiffuseDensity::power, "The sum of all echoes.")
      .def_property_readonly(
          "mean_delay",
          [](const DiffuseDensity& density) { return density.power_delay().mean_delay; },
          "[s]; 0 where there is no echo.")
      .def_property_readonly(
          "delay_spread",
          [](const DiffuseDensity& density) { return density.power_delay().delay_spread; },
          "Root mean square about the mean delay [s].")
      .def_property_readonly(
          "error", &DiffuseDensity::error, "By what the total power may be off, estimated.")
      .def("profile",
           profile,
           py::arg("first"),
           py::arg("step"),
           py::arg("bins"),
           "Power by delay, (bins,): bin i begins at first + i * step [s].")
      .def("__len__", [](const DiffuseDensity& density) { return density.echoes().size(); });
}

}  // namespace rayloc::python
