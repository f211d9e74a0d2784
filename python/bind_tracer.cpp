// trace: links of a scene, one or many.
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "daemon/lab/trace/named_parameters.h"
#include "engine/base/parallel.h"
#include "engine/trace/diffuse/rough_materials.h"
#include "engine/trace/link_change.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raising.h"
#include "python/tracing.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

using SharedPaths = std::shared_ptr<LinkPaths>;

TracerHandle tracer_of(const SceneHandle& scene,
                       int max_depth,
                       bool refraction,
                       double softness,
                       int diffraction,
                       bool diffuse_reflection) {
  constexpr int kMaxDepth = 16;  // a count, as `rayloc trace --depth`
  if (max_depth < 0 || max_depth > kMaxDepth) {
    refuse("max_depth is from 0 to 16");
  }
  if (!(softness >= 0.0 && softness <= 10.0)) {
    refuse("softness is from 0 to 10 m");
  }
  if (diffraction < 0 || diffraction > 2) {
    refuse("diffraction is 0, 1 (or True) or 2 edges");
  }
  if (softness > 0.0 && diffraction > 0) {
    refuse("diffraction goes with hard edges only: leave softness at 0");
  }
  if (diffuse_reflection) {
    if (auto scatters = check_scatters(*scene.scene); !scatters) {
      throw Raised{std::move(scatters.error())};
    }
  }
  TraceOptions options;
  options.max_depth = max_depth;
  options.transmission = refraction;
  options.softness = softness;
  options.diffraction = diffraction > 0;
  options.double_diffraction = diffraction > 1;
  options.diffuse = diffuse_reflection;
  const py::gil_scoped_release unlocked;
  return {scene, PathTracer(scene.scene, options)};
}

void check_ends(const Transmitter& transmitter, const Receiver& receiver) {
  if (transmitter.position == receiver.position) {
    refuse("transmitter and receiver are the same point; give two different points");
  }
}

SharedPaths link_of(const TracerHandle& handle,
                    const Transmitter& transmitter,
                    const ReceiverTracer& at_receiver) {
  return std::make_shared<LinkPaths>(LinkPaths{handle.scene.scene,
                                               at_receiver,
                                               transmitter,
                                               at_receiver.trace(transmitter),
                                               handle.tracer.options()});
}

SharedPaths trace_link(const TracerHandle& handle,
                       const Transmitter& transmitter,
                       const Receiver& receiver) {
  check_ends(transmitter, receiver);
  const py::gil_scoped_release unlocked;
  return link_of(handle, transmitter, handle.tracer.at(receiver));
}

// [transmitter][receiver]. One tree per receiver serves all transmitters.
std::vector<std::vector<SharedPaths>> trace_links(const TracerHandle& handle,
                                                  const std::vector<Transmitter>& transmitters,
                                                  const std::vector<Receiver>& receivers) {
  for (const Transmitter& transmitter : transmitters) {
    for (const Receiver& receiver : receivers) {
      check_ends(transmitter, receiver);
    }
  }
  const py::gil_scoped_release unlocked;
  std::vector<std::optional<ReceiverTracer>> trees(receivers.size());
  parallel_for(receivers.size(), 1, [&](std::size_t r) {
    trees[r].emplace(handle.tracer.at(receivers[r]));
  });
  std::vector<std::vector<SharedPaths>> links(transmitters.size(),
                                              std::vector<SharedPaths>(receivers.size()));
  parallel_for(transmitters.size() * receivers.size(), 1, [&](std::size_t i) {
    const std::size_t t = i / receivers.size();
    const std::size_t r = i % receivers.size();
    links[t][r] = link_of(handle, transmitters[t], *trees[r]);
  });
  return links;
}

// The tree of one receiver, used for several transmitters in turn.
struct ReceiverHandle {
  TracerHandle tracer;
  ReceiverTracer at_receiver;
};

SharedPaths trace_from(const ReceiverHandle& handle, const Transmitter& transmitter) {
  check_ends(transmitter, handle.at_receiver.receiver());
  const py::gil_scoped_release unlocked;
  return link_of(handle.tracer, transmitter, handle.at_receiver);
}

std::vector<std::string> parameter_names(const SceneHandle& handle) {
  std::vector<std::string> names{"tx",
                                 "rx",
                                 "tx_orientation",
                                 "rx_orientation",
                                 "tx_array_turn",
                                 "rx_array_turn",
                                 "tx_gain",
                                 "rx_gain"};
  for (const SceneObject& object : handle.scene->objects()) {
    names.push_back("object." + object.name);
    names.push_back("offset." + object.name);
  }
  for (const RadioMaterial& material : handle.scene->materials()) {
    for (const char* what : {"eps_r.", "sigma.", "thickness."}) {
      names.push_back(what + material.name);
    }
  }
  return names;
}

using Values = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::tuple changed(const SceneHandle& handle,
                  const Transmitter& transmitter,
                  const Receiver& receiver,
                  const std::vector<std::string>& names,
                  const Values& by) {
  const NamedParameters named = parameters_of(names, *handle.scene);
  if (by.ndim() != 1 || by.shape(0) != size_of(named.parameters.size())) {
    refuse("changed: there are " + std::to_string(named.parameters.size()) +
           " parameters, and one value for each is needed");
  }
  const std::span<const double> values(by.data(), named.parameters.size());
  std::optional<ChangedLink> link;
  {
    const py::gil_scoped_release unlocked;
    link =
        value_of(change_link({handle.scene, transmitter, receiver, 1.0}, named.parameters, values));
  }
  return py::make_tuple(
      SceneHandle{handle.name, link->scene}, link->transmitter, link->receiver, link->gain);
}

void bind_receiver_tracer(py::module_& module) {
  py::class_<ReceiverHandle>(
      module, "ReceiverTracer", R"(Tracer of the paths to one receiver, built once.

Made by `Tracer.at`; tracing from many transmitters is then fast.

Shapes: none. Units: metres. Frame: world, right-handed, z up.
Errors: `trace` raises rayloc.Error where both ends are the same point.
Source: engine/trace/path_tracer.h.)")
      .def("trace", trace_from, py::arg("tx"), "The Paths from a Transmitter to this receiver.");
}

}  // namespace

NamedParameters parameters_of(const std::vector<std::string>& names, const Scene& scene) {
  NamedParameters found;
  for (const std::string& name : names) {
    for (auto& each : value_of(parse_parameters(name, scene))) {
      found.names.push_back(std::move(each.name));
      found.parameters.push_back(each.parameter);
    }
  }
  return found;
}

void bind_tracer(py::module_& module) {
  py::class_<TracerHandle>(module, "Tracer", R"(Traces links of a scene.

Args:
    scene: a scene of load_scene.
    max_depth: most interactions of a path, 0 to 16.
    refraction: also straight through objects; each face that is crossed counts for the depth.
    softness: distance from its edge over which a face begins to reflect and to shadow [m].
    diffraction: 1 (or True): also round one edge, with at most two interactions on each side of
        it; the edge counts for the depth. 2: also round two edges in a row, which takes longer as
        the number of edges squared. Not with softness.
    diffuse_reflection: rough materials reflect less; `Paths.diffuse` has the scattered echoes.

Shapes: none. Units: metres. Frame: world, right-handed, z up.
Errors: rayloc.Error for an argument out of its range, where both ends are the same point, and for
    diffuse_reflection where no material of the scene scatters.
Source: engine/trace/path_tracer.h. All paths are found, none twice; many threads may trace at once.)")
      .def(py::init(&tracer_of),
           py::arg("scene"),
           py::arg("max_depth") = kDefaultMaxDepth,
           py::arg("refraction") = false,
           py::arg("softness") = 0.0,
           py::arg("diffraction") = 0,
           py::arg("diffuse_reflection") = false)
      .def("trace", trace_link, py::arg("tx"), py::arg("rx"), "The Paths of a link.")
      .def("trace_all",
           trace_links,
           py::arg("tx"),
           py::arg("rx"),
           "The Paths of every pair, [tx][rx], on all cores and without the lock of Python.")
      .def(
          "at",
          [](const TracerHandle& handle, const Receiver& receiver) {
            const py::gil_scoped_release unlocked;
            return ReceiverHandle{handle, handle.tracer.at(receiver)};
          },
          py::arg("rx"),
          "A ReceiverTracer, for many transmitters.");
  bind_receiver_tracer(module);
  module.def("parameter_names",
             parameter_names,
             py::arg("scene"),
             R"(All parameters by which a link of the scene can be differentiated.

`tx`, `rx`, `..._orientation`, `..._array_turn` and `object.NAME` have three numbers each: ".0", ".1"
or ".2" behind the name selects one. `offset.NAME` has one for each surface of the object. Paths that
were traced with diffuse_reflection have `scattering.NAME` of a rough material, too.

Args:
    scene: a scene of load_scene.

Returns:
    Names for `Paths.derivatives`, `gradient` and `changed`.

Shapes: none.
Units: metres (tx, rx, object, offset, thickness), radians (orientation, array_turn), S/m (sigma),
    1 (gains, eps_r).
Frame: world; offset along the surface's normal.
Errors: none.
Source: engine/trace/parameter.h.)");
  module.def("changed_link",
             changed,
             py::arg("scene"),
             py::arg("tx"),
             py::arg("rx"),
             py::arg("parameters"),
             py::arg("by"),
             "scene, tx, rx and the amplitude factor with each parameter changed by its value.");
}

}  // namespace rayloc::python
