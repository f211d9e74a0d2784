// change_link: applies changes of Parameters to a link: the function that the derivatives refer to,
// and the step of a descent.
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

// Changes each parameter by its value, in order; changes of one number by two parameters add up.
// The scene is copied only where it changes. An Error when a parameter does not exist in the
// scene, a value is not finite, or the result is no valid scene (Scene::create). REQUIRES: as many
// values as parameters.
Expected<ChangedLink> change_link(const ChangedLink& link,
                                  std::span<const Parameter> parameters,
                                  std::span<const double> by);

}  // namespace rayloc
