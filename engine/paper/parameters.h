// Parameters: the parameters of a scene that the paper's calibration changes: positions of
// objects (each moved as a whole), and the relative permittivity and conductivity of materials.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/scene/scene.h"
#include "engine/trace/parameter.h"

namespace rayloc::paper {

class Parameters {
 public:
  // For the objects that are `met` and their materials. An object that no path meets has no effect.
  Parameters(std::shared_ptr<const Scene> scene, const std::vector<bool>& met);

  // Three axes of each object.
  const std::vector<Parameter>& objects() const { return objects_; }
  // Permittivity and conductivity of each material.
  const std::vector<Parameter>& materials() const { return materials_; }

  struct Values {
    std::vector<double> translation;  // [m], of objects(), relative to the given scene
    std::vector<double> material;     // of materials(): 1 and S/m
  };
  Values initial() const;

  // Sets non-physical values to the nearest physical one: permittivity >= 1, conductivity >= 0.
  void project(Values& values) const;

  // The scene with these values. Errors: as of Scene::create().
  Expected<std::shared_ptr<const Scene>> scene_with(const Values& values) const;

  // "table.x" [m] with prior 0, "wood.relative_permittivity", "wood.conductivity" [S/m]. The
  // paper's method has no prior and no posterior width.
  std::vector<RoomParameter> describe(const Values& values) const;

 private:
  std::shared_ptr<const Scene> scene_;
  std::vector<Parameter> objects_;
  std::vector<Parameter> materials_;
};

}  // namespace rayloc::paper
