// change_link: a link with some of its Parameters changed: what their derivatives are derivatives
// of, and what a descent needs for its next step.
#pragma once

#include <memory>
#include <span>

#include "engine/base/expected.h"
#include "engine/scene/scene.h"
#include "engine/trace/parameter.h"
#include "engine/trace/radio_device.h"

namespace rayloc {

struct ChangedLink {
  std::shared_ptr<const Scene> scene;
  Transmitter transmitter;
  Receiver receiver;
  double gain = 1.0;  // amplitude factor of both antennas
};

// Each parameter by its value, in their order: what two of them say of one number adds up. The
// scene is a new one only where it changes. An Error when a parameter does not exist in the scene,
// a value is not finite, or what results is no scene (Scene::create). REQUIRES: as many values as
// parameters.
Expected<ChangedLink> change_link(const ChangedLink& link,
                                  std::span<const Parameter> parameters,
                                  std::span<const double> by);

}  // namespace rayloc
