// load_scene and Scene.
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "daemon/site/model/room_model.h"
#include "daemon/site/scene/scene_source.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raising.h"
#include "python/tracing.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

using Names = std::vector<std::string>;

SceneHandle load(const std::filesystem::path& file, std::optional<double> frequency) {
  if (frequency && !(std::isfinite(*frequency) && *frequency > 0.0)) {
    refuse("load_scene: frequency is the carrier in Hz, above 0");
  }
  const py::gil_scoped_release unlocked;
  SceneSource source = value_of(load_scene_source(file, frequency));
  return {std::move(source.name), std::move(source.scene)};
}

template <typename Values>
Names names_of(const Values& values) {
  Names names;
  names.reserve(values.size());
  for (const auto& value : values) {
    names.push_back(value.name);
  }
  return names;
}

py::dict materials_of(const SceneHandle& handle) {
  py::dict materials;
  for (const RadioMaterial& material : handle.scene->materials()) {
    py::dict values;
    values["relative_permittivity"] = material.relative_permittivity;
    values["conductivity"] = material.conductivity;
    values["thickness"] = material.thickness;
    materials[py::str(material.name)] = std::move(values);
  }
  return materials;
}

py::array_t<double> bounds_of(const SceneHandle& handle) {
  const Vec3d lower = handle.scene->bounds_min();
  const Vec3d upper = handle.scene->bounds_max();
  return array_of(std::vector<double>{lower.x, lower.y, lower.z, upper.x, upper.y, upper.z},
                  {2, 3});
}

// Vertices are Vec3d, three doubles each, so that a row is a vertex.
py::array_t<double> object_vertices(const py::object& self, const std::string& object) {
  const auto& handle = self.cast<const SceneHandle&>();
  for (const SceneObject& each : handle.scene->objects()) {
    if (each.name == object) {
      static_assert(sizeof(Vec3d) == 3 * sizeof(double));
      const auto& vertices = each.mesh.vertices;
      return view_of<double>(vertices.empty() ? nullptr : &vertices.front().x,
                             {size_of(vertices.size()), 3},
                             {sizeof(Vec3d), sizeof(double)},
                             self);
    }
  }
  refuse("Scene.vertices: the scene has no object '" + object + "'");
}

py::str text_of(const SceneHandle& handle) {
  return py::str("Scene('{}', {} objects, {} surfaces, {:.6g} Hz)")
      .format(handle.name,
              handle.scene->objects().size(),
              handle.scene->surfaces().size(),
              handle.scene->carrier_hz());
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<SceneHandle>(module, "Scene", R"(A place as planar surfaces with radio materials.

Made by `load_scene`; it never changes, and many threads may use it at once.

Shapes: `vertices(name)` is (vertices, 3), `bounds` is (2, 3).
Units: metres, hertz, siemens per metre.
Frame: the world of the scene file, right-handed, z up.
Errors: `vertices` raises rayloc.Error where the scene has no such object.
Source: engine/scene/scene.h.)")
      .def_readonly("name", &SceneHandle::name, "Name of the site, else of the file.")
      .def_property_readonly(
          "frequency",
          [](const SceneHandle& handle) { return handle.scene->carrier_hz(); },
          "The carrier, at which materials are evaluated [Hz].")
      .def_property_readonly(
          "objects",
          [](const SceneHandle& handle) { return names_of(handle.scene->objects()); },
          "Names of the objects, in the order of `Paths.objects`.")
      .def_property_readonly("radio_materials",
                             materials_of,
                             "By name: relative_permittivity [1], conductivity [S/m], thickness "
                             "[m] at the carrier.")
      .def_property_readonly("bounds", bounds_of, "Least and greatest corner [m], world, (2, 3).")
      .def_property_readonly(
          "surfaces",
          [](const SceneHandle& handle) { return handle.scene->surfaces().size(); },
          "How many planar surfaces there are.")
      .def("vertices",
           object_vertices,
           py::arg("object"),
           "Corners of an object [m], world, (vertices, 3); a view, nothing is copied.")
      .def("__repr__", text_of);
  module.def("load_scene",
             load,
             py::arg("path"),
             py::arg("frequency") = py::none(),
             R"(Reads a scene: Mitsuba XML as Sionna RT writes it, or a site.

Args:
    path: the XML, or a directory with site.toml, whose carrier and materials then hold.
    frequency: the carrier [Hz]; None: that of the site, else 5.18e9.

Returns:
    A Scene.

Shapes: none. Units: hertz. Frame: the world of the file, metres, right-handed, z up.
Errors: rayloc.Error names file:line:column, what is wrong and what to write instead.
Source: engine/scene/read/load_scene.h; materials of ITU-R P.2040-4.)");
}

}  // namespace rayloc::python
