// C++ objects held by Python for a link: scenes, tracers, paths with their inputs, derivatives.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "engine/channel/ofdm_grid.h"
#include "engine/scene/scene.h"
#include "engine/trace/path_tracer.h"

namespace rayloc::python {

struct SceneHandle {
  std::string name;
  std::shared_ptr<const Scene> scene;
};

struct TracerHandle {
  SceneHandle scene;
  PathTracer tracer;
};

// The paths of a link and all data needed to differentiate them.
struct LinkPaths {
  std::shared_ptr<const Scene> scene;
  ReceiverTracer at_receiver;
  Transmitter transmitter;
  Paths paths;
  TraceOptions options;
};

struct LinkDerivatives {
  std::shared_ptr<const LinkPaths> link;
  std::vector<std::string> names;
  PathDerivatives values;
};

// Parameters of the link by name, as in `rayloc trace --gradient`. Raises on unknown names.
struct NamedParameters {
  std::vector<std::string> names;
  std::vector<Parameter> parameters;
};
NamedParameters parameters_of(const std::vector<std::string>& names, const Scene& scene);

}  // namespace rayloc::python
