#include "engine/trace/link_change.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/scene/moved_surfaces.h"

namespace rayloc {
namespace {

using Kind = Parameter::Kind;

Vec3d along(int axis, double by) {
  return {axis == 0 ? by : 0.0, axis == 1 ? by : 0.0, axis == 2 ? by : 0.0};
}

void turn(RadioDevice& device, int axis, double by) {
  Orientation& o = device.orientation;
  (axis == 0 ? o.yaw : axis == 1 ? o.pitch : o.roll) += by;
}

// Turns about the origin of the array: the antenna moves as well.
void turn_array(RadioDevice& device, int axis, double by) {
  const Vec3d origin = device.position - rotation(device.orientation) * device.lever;
  turn(device, axis, by);
  device.position = origin + rotation(device.orientation) * device.lever;
}

// Applies a parameter of one of the ends; false for any other parameter.
bool change_ends(ChangedLink& link, const Parameter& parameter, double by) {
  switch (parameter.kind) {
    case Kind::kTransmitterPosition:
      link.transmitter.position = link.transmitter.position + along(parameter.axis, by);
      return true;
    case Kind::kReceiverPosition:
      link.receiver.position = link.receiver.position + along(parameter.axis, by);
      return true;
    case Kind::kTransmitterOrientation:
      turn(link.transmitter, parameter.axis, by);
      return true;
    case Kind::kReceiverOrientation:
      turn(link.receiver, parameter.axis, by);
      return true;
    case Kind::kTransmitterArrayTurn:
      turn_array(link.transmitter, parameter.axis, by);
      return true;
    case Kind::kReceiverArrayTurn:
      turn_array(link.receiver, parameter.axis, by);
      return true;
    case Kind::kTransmitterGain:
    case Kind::kReceiverGain:
      link.gain *= 1.0 + by;
      return true;
    default:
      return false;
  }
}

// Changes of the scene: surfaces are moved first, so that their current numbers apply.
class SceneChange {
 public:
  explicit SceneChange(const Scene& scene)
      : scene_(scene),
        offsets_(scene.surfaces().size(), 0.0),
        moves_(scene.objects().size()),
        materials_(scene.materials()) {}

  static double& value_of(Kind kind, RadioMaterial& material) {
    switch (kind) {
      case Kind::kRelativePermittivity:
        return material.relative_permittivity;
      case Kind::kConductivity:
        return material.conductivity;
      case Kind::kScatteringCoefficient:
        return material.scattering.scattering_coefficient;
      case Kind::kXpdCoefficient:
        return material.scattering.xpd_coefficient;
      case Kind::kAlphaReflected:
        return material.scattering.alpha_r;
      case Kind::kAlphaBack:
        return material.scattering.alpha_i;
      case Kind::kLobeShare:
        return material.scattering.lambda;
      default:
        return material.thickness;
    }
  }

  Expected<void> add(const Parameter& parameter, double by) {
    const bool is_object = parameter.kind == Kind::kObjectTranslation;
    const bool is_surface = parameter.kind == Kind::kSurfaceOffset;
    const std::size_t count = is_object    ? moves_.size()
                              : is_surface ? offsets_.size()
                                           : materials_.size();
    if (parameter.index >= count) {
      return make_error(ErrorKind::kUsage, "a parameter that the scene does not have");
    }
    changed_ = true;
    if (is_object) {
      moves_[parameter.index] = moves_[parameter.index] + along(parameter.axis, by);
    } else if (is_surface) {
      offsets_[parameter.index] += by;
      offset_ = true;
    } else {
      value_of(parameter.kind, materials_[parameter.index]) += by;
    }
    return {};
  }

  bool is_change() const { return changed_; }

  Expected<Scene> made() const {
    std::vector<SceneObject> objects = scene_.objects();
    if (offset_) {
      auto moved = move_surfaces(scene_, offsets_);
      if (!moved) {
        return moved;
      }
      objects = moved->objects();
    }
    for (std::size_t i = 0; i < objects.size(); ++i) {
      for (Vec3d& vertex : objects[i].mesh.vertices) {
        vertex = vertex + moves_[i];
      }
    }
    return Scene::create({std::move(objects), materials_, scene_.carrier_hz()});
  }

 private:
  const Scene& scene_;
  std::vector<double> offsets_;
  std::vector<Vec3d> moves_;
  std::vector<RadioMaterial> materials_;
  bool changed_ = false;
  bool offset_ = false;
};

}  // namespace

Expected<ChangedLink> change_link(const ChangedLink& link,
                                  std::span<const Parameter> parameters,
                                  std::span<const double> by) {
  RAYLOC_CHECK(by.size() == parameters.size());
  ChangedLink changed = link;
  SceneChange scene(*link.scene);
  for (std::size_t i = 0; i < by.size(); ++i) {
    if (!std::isfinite(by[i])) {
      return make_error(ErrorKind::kUsage, "a parameter is changed by a value that is not finite");
    }
    if (!change_ends(changed, parameters[i], by[i])) {
      RAYLOC_TRY(scene.add(parameters[i], by[i]));
    }
  }
  if (scene.is_change()) {
    auto made = scene.made();
    RAYLOC_TRY(made);
    changed.scene = std::make_shared<const Scene>(*std::move(made));
  }
  return changed;
}

}  // namespace rayloc
