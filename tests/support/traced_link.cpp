#include "tests/support/traced_link.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <utility>

#include "engine/scene/read/load_scene.h"
#include "engine/trace/interactions/interaction.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::test {
namespace {

using Kind = Parameter::Kind;

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "traced_link: %s\n", why.c_str());
  std::abort();
}

Vec3d along(int axis, double by) {
  return {axis == 0 ? by : 0.0, axis == 1 ? by : 0.0, axis == 2 ? by : 0.0};
}

void turn(Orientation& orientation, int axis, double by) {
  (axis == 0 ? orientation.yaw : axis == 1 ? orientation.pitch : orientation.roll) += by;
}

template <typename Device>
void change_device(Device& device, Kind position, Kind orientation, const Parameter& p, double by) {
  if (p.kind == position) {
    device.position = device.position + along(p.axis, by);
  } else if (p.kind == orientation) {
    turn(device.orientation, p.axis, by);
  } else {
    const Vec3d origin = device.position - rotation(device.orientation) * device.lever;
    turn(device.orientation, p.axis, by);
    device.position = origin + rotation(device.orientation) * device.lever;
  }
}

Scene::Input input_of(const Scene& scene) {
  return {scene.objects(), scene.materials(), scene.carrier_hz()};
}

Scene::Input room_of(const std::string& name) {
  if (name == "box") {
    Scene::Input input;
    input.carrier_hz = kCarrier;
    input.materials = {kConcrete, {"glass", 6.31, 0.0326, 0.01}};
    const std::vector<Mesh> walls{rectangle_mesh({-5, -5, 0}, {0, 10, 0}, {0, 0, 5}),
                                  rectangle_mesh({5, -5, 0}, {0, 10, 0}, {0, 0, 5}),
                                  rectangle_mesh({-5, -5, 0}, {10, 0, 0}, {0, 0, 5}),
                                  rectangle_mesh({-5, 5, 0}, {10, 0, 0}, {0, 0, 5}),
                                  rectangle_mesh({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}),
                                  rectangle_mesh({-5, -5, 5}, {10, 0, 0}, {0, 10, 0})};
    for (std::size_t i = 0; i < walls.size(); ++i) {
      input.objects.push_back({"wall" + std::to_string(i), walls[i], 0});
    }
    input.objects.push_back({"cupboard", box_mesh({0.2, -0.7, 0.4}, {0.8, 0.1, 1.9}), 1});
    return input;
  }
  const std::string file = name == "corridor" ? "/scenes/corridor" : "/sites/meeting_room";
  const auto scene = load_scene(data_path() + file + "/scene.xml", {kCarrier, {}});
  return scene ? input_of(*scene) : (give_up(scene.error().message), Scene::Input{});
}

struct Places {
  Vec3d array;
  Vec3d device;
  Vec3d screen;  // a corner; 0.9 m along x, 0.7 m up
};
const std::map<std::string, Places> kPlaces{
    {"box", {{-3.1, 1.2, 2.2}, {2.7, -0.9, 1.3}, {-0.4, 2.1, 1.1}}},
    {"meeting_room", {{-1.45, 1.13, 2.25}, {0.412, 1.037, 1.519}, {-0.6, -0.9, 1.2}}},
    {"corridor", {{3.1, 0.7, 2.2}, {9.2, 0.6, 1.3}, {5.4, -0.6, 1.0}}}};

}  // namespace

TracedLink::TracedLink(Scene::Input input,
                       std::vector<Transmitter> transmitters,
                       std::vector<Receiver> receivers,
                       const TraceOptions& options)
    : input_(std::move(input)),
      transmitters_(std::move(transmitters)),
      receivers_(std::move(receivers)),
      options_(options) {
  auto scene = Scene::create(input_);
  if (!scene) {
    give_up(scene.error().message);
  }
  scene_ = std::make_shared<const Scene>(std::move(*scene));
  grid_ = {input_.carrier_hz - 20e6, 312'500.0, {}};
  for (std::int16_t i = 0; i < 128; ++i) {
    grid_.tone_index.push_back(i);
  }
}

TracedLink TracedLink::of(const std::string& name, const TraceOptions& options) {
  Scene::Input input = room_of(name);
  const Places& places = kPlaces.at(name);
  input.objects.push_back({"screen", rectangle_mesh(places.screen, {0.9, 0.3, 0}, {0, 0, 0.7}), 0});
  AntennaArray array;
  array.pose = {places.array, {-0.65, 0.1, 0.05}};
  array.element_offset = {{0, -0.089, 0}, {0, 0, 0}, {0, 0.089, 0}};
  array.pattern = AntennaPattern::kHalfWaveDipole;
  Receiver device{{places.device, {0.3, -0.2, 0.5}}};
  device.lever = {0.03, -0.05, 0.02};
  return {std::move(input), array_elements<Transmitter>(array), {device}, options};
}

TracedLink TracedLink::changed(const Parameter& parameter, double by) const {
  TracedLink copy = *this;
  switch (parameter.kind) {
    case Kind::kTransmitterPosition:
    case Kind::kTransmitterOrientation:
    case Kind::kTransmitterArrayTurn:
      for (Transmitter& device : copy.transmitters_) {
        change_device(
            device, Kind::kTransmitterPosition, Kind::kTransmitterOrientation, parameter, by);
      }
      return copy;
    case Kind::kReceiverPosition:
    case Kind::kReceiverOrientation:
    case Kind::kReceiverArrayTurn:
      for (Receiver& device : copy.receivers_) {
        change_device(device, Kind::kReceiverPosition, Kind::kReceiverOrientation, parameter, by);
      }
      return copy;
    case Kind::kTransmitterGain:
    case Kind::kReceiverGain:
      copy.gain_ += by;
      return copy;
    default:
      copy.change_scene(parameter, by);
      return {copy.input_, transmitters_, receivers_, options_};
  }
}

void TracedLink::change_scene(const Parameter& parameter, double by) {
  switch (parameter.kind) {
    case Kind::kObjectTranslation:
      for (Vec3d& vertex : input_.objects[parameter.index].mesh.vertices) {
        vertex = vertex + along(parameter.axis, by);
      }
      return;
    case Kind::kSurfaceOffset: {
      const Plane<double>& plane = scene_->surfaces()[parameter.index].plane();
      Mesh& mesh = input_.objects[scene_->owner(parameter.index).object].mesh;
      for (Vec3d& vertex : mesh.vertices) {
        if (std::abs(distance(plane, vertex)) < kCoplanarTolerance) {
          vertex = vertex + by * plane.normal;
        }
      }
      return;
    }
    case Kind::kRelativePermittivity:
      input_.materials[parameter.index].relative_permittivity += by;
      return;
    case Kind::kConductivity:
      input_.materials[parameter.index].conductivity += by;
      return;
    default:
      input_.materials[parameter.index].thickness += by;
  }
}

void TracedLink::for_each_pair(
    const std::function<void(const Transmitter&, const ReceiverTracer&)>& visit) const {
  const PathTracer tracer(scene_, options_);
  for (const Receiver& receiver : receivers_) {
    const ReceiverTracer at_receiver = tracer.at(receiver);
    for (const Transmitter& transmitter : transmitters_) {
      visit(transmitter, at_receiver);
    }
  }
}

Csi TracedLink::csi() const {
  Csi h;
  for_each_pair([&](const Transmitter& transmitter, const ReceiverTracer& at_receiver) {
    for (const auto& value : at_receiver.trace(transmitter).cfr(grid_)) {
      h.push_back(gain_ * value);
    }
  });
  return h;
}

Csi TracedLink::reference() const {
  TracedLink displaced = *this;
  for (Receiver& receiver : displaced.receivers_) {
    receiver.position = receiver.position + Vec3d{0.02, -0.013, 0.017};
  }
  return displaced.csi();
}

std::vector<std::uint32_t> TracedLink::path_keys() const {
  std::vector<std::uint32_t> keys;
  for_each_pair([&](const Transmitter& transmitter, const ReceiverTracer& at_receiver) {
    for (const Path& path : at_receiver.trace(transmitter)) {
      for (const Interaction& interaction : path.interactions) {
        keys.push_back(2 * interaction.surface + (is_mirror(interaction.kind) ? 1U : 0U));
        if (is_edge(interaction.kind)) {
          keys.push_back(interaction.edge);
        }
      }
      keys.push_back(kNoSurface);
    }
  });
  return keys;
}

std::vector<Parameter> TracedLink::parameters() const {
  std::vector<Parameter> result{Parameter::transmitter_gain(), Parameter::receiver_gain()};
  for (int axis = 0; axis < 3; ++axis) {
    result.push_back(Parameter::transmitter_position(axis));
    result.push_back(Parameter::receiver_position(axis));
    result.push_back(Parameter::transmitter_orientation(axis));
    result.push_back(Parameter::receiver_orientation(axis));
    result.push_back(Parameter::transmitter_array_turn(axis));
    result.push_back(Parameter::receiver_array_turn(axis));
  }
  for (std::uint32_t i = 0; i < input_.materials.size(); ++i) {
    if (input_.materials[i].relative_permittivity > 1.01) {  // no step below that of vacuum
      result.push_back(Parameter::relative_permittivity(i));
    }
    result.push_back(Parameter::conductivity(i));
    result.push_back(Parameter::thickness(i));
  }
  std::map<std::uint32_t, int> uses;
  for_each_pair([&](const Transmitter& transmitter, const ReceiverTracer& at_receiver) {
    for (const Path& path : at_receiver.trace(transmitter)) {
      for (const Interaction& interaction : path.interactions) {
        ++uses[interaction.surface];
      }
    }
  });
  std::vector<std::pair<int, std::uint32_t>> busiest;
  busiest.reserve(uses.size() + 1);
  for (const auto& [surface, count] : uses) {
    busiest.emplace_back(-count, surface);
  }
  std::sort(busiest.begin(), busiest.end());
  busiest.resize(std::min<std::size_t>(busiest.size(), 6));
  const auto screen = static_cast<std::uint32_t>(scene_->surfaces().size() - 1);
  busiest.emplace_back(0, screen);
  for (const auto& [count, surface] : busiest) {
    const std::uint32_t object = scene_->owner(surface).object;
    for (int axis = 0; axis < 3; ++axis) {
      result.push_back(Parameter::object_translation(object, axis));
    }
    // Moving one face of a body stretches its other faces, which affects soft edges.
    if (options_.softness == 0.0 || scene_->objects()[object].mesh.triangles.size() == 2) {
      result.push_back(Parameter::surface_offset(surface));
    }
  }
  return result;
}

std::string TracedLink::name_of(const Parameter& parameter) const {
  std::string axis = "." + std::to_string(parameter.axis);
  switch (parameter.kind) {
    case Kind::kObjectTranslation:
      return scene_->objects()[parameter.index].name + axis;
    case Kind::kSurfaceOffset:
      return scene_->objects()[scene_->owner(parameter.index).object].name + " surface " +
             std::to_string(parameter.index);
    case Kind::kRelativePermittivity:
    case Kind::kConductivity:
    case Kind::kThickness:
      return scene_->materials()[parameter.index].name;
    default:
      return axis;
  }
}

Csi TracedLink::csi_derivative(const Parameter& parameter) const {
  Csi result;
  for_each_pair([&](const Transmitter& transmitter, const ReceiverTracer& at_receiver) {
    const Paths paths = at_receiver.trace(transmitter);
    const auto derivatives =
        at_receiver.differentiate(transmitter, paths, std::span(&parameter, 1));
    if (!derivatives) {
      give_up(derivatives.error().message);
    }
    const Csi part = derivatives->cfr(paths, grid_, 0);
    result.insert(result.end(), part.begin(), part.end());
  });
  return result;
}

std::vector<double> TracedLink::gradient(const std::vector<Parameter>& parameters,
                                         const std::function<Csi(const Csi&)>& adjoint) const {
  const Csi g = adjoint(csi());
  std::vector<double> sum(parameters.size(), 0.0);
  std::size_t first = 0;
  for_each_pair([&](const Transmitter& transmitter, const ReceiverTracer& at_receiver) {
    const Paths paths = at_receiver.trace(transmitter);
    const auto derivatives = at_receiver.differentiate(transmitter, paths, parameters);
    if (!derivatives) {
      give_up(derivatives.error().message);
    }
    const std::vector<double> part =
        derivatives->loss_gradient(paths, grid_, std::span(g).subspan(first, grid_.size()));
    first += grid_.size();
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += part[i];
    }
  });
  return sum;
}

double difference_step(const Parameter& parameter) {
  switch (parameter.kind) {
    case Kind::kTransmitterOrientation:
    case Kind::kReceiverOrientation:
    case Kind::kTransmitterArrayTurn:
    case Kind::kReceiverArrayTurn:
      return 1e-4;
    case Kind::kTransmitterGain:
    case Kind::kReceiverGain:
    case Kind::kRelativePermittivity:
      return 1e-3;
    case Kind::kConductivity:
      return 1e-4;
    case Kind::kThickness:
      return 2e-6;
    default:
      return 2e-5;
  }
}

}  // namespace rayloc::test
