// PaperParameters: what the paper's calibration changes of a scene: where objects are (each moved
// as a whole), and the relative permittivity and conductivity of materials.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/scene/scene.h"
#include "engine/trace/parameter.h"

namespace rayloc {

class PaperParameters {
 public:
  // Of the objects that are `met` and the materials of these. What no path meets has no effect.
  PaperParameters(std::shared_ptr<const Scene> scene, const std::vector<bool>& met);

  // Three axes of each object.
  const std::vector<Parameter>& objects() const { return objects_; }
  // Permittivity and conductivity of each material.
  const std::vector<Parameter>& materials() const { return materials_; }

  struct Values {
    std::vector<double> translation;  // [m], of objects(), against the scene as given
    std::vector<double> material;     // of materials(): 1 and S/m
  };
  Values initial() const;

  // Sets what is not physical to the nearest that is: permittivity >= 1, conductivity >= 0.
  void project(Values& values) const;

  // The scene with these values. An Error as of Scene::create().
  Expected<std::shared_ptr<const Scene>> scene_with(const Values& values) const;

  // "table.x" [m] with prior 0, "wood.relative_permittivity", "wood.conductivity" [S/m]. The
  // paper's method states no prior and no posterior width.
  std::vector<RoomParameter> describe(const Values& values) const;

 private:
  std::shared_ptr<const Scene> scene_;
  std::vector<Parameter> objects_;
  std::vector<Parameter> materials_;
};

}  // namespace rayloc
