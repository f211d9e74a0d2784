#include "engine/paper/parameters.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "engine/base/check.h"

namespace rayloc::paper {
namespace {

using Kind = Parameter::Kind;

}  // namespace

Parameters::Parameters(std::shared_ptr<const Scene> scene, const std::vector<bool>& met)
    : scene_(std::move(scene)) {
  RAYLOC_CHECK(met.size() == scene_->objects().size());
  std::vector<bool> is_used(scene_->materials().size());
  for (std::uint32_t object = 0; object < met.size(); ++object) {
    if (met[object]) {
      for (int axis = 0; axis < 3; ++axis) {
        objects_.push_back(Parameter::object_translation(object, axis));
      }
      is_used[scene_->objects()[object].material] = true;
    }
  }
  for (std::uint32_t material = 0; material < is_used.size(); ++material) {
    if (is_used[material]) {
      materials_.push_back(Parameter::relative_permittivity(material));
      materials_.push_back(Parameter::conductivity(material));
    }
  }
}

Parameters::Values Parameters::initial() const {
  Values values{std::vector<double>(objects_.size()), {}};
  for (const Parameter& parameter : materials_) {
    const RadioMaterial& material = scene_->materials()[parameter.index];
    values.material.push_back(parameter.kind == Kind::kConductivity
                                  ? material.conductivity
                                  : material.relative_permittivity);
  }
  return values;
}

void Parameters::project(Values& values) const {
  RAYLOC_CHECK(values.material.size() == materials_.size());
  for (std::size_t i = 0; i < materials_.size(); ++i) {
    const double least = materials_[i].kind == Kind::kConductivity ? 0.0 : 1.0;
    values.material[i] = std::max(values.material[i], least);
  }
}

Expected<std::shared_ptr<const Scene>> Parameters::scene_with(const Values& values) const {
  RAYLOC_CHECK(values.translation.size() == objects_.size());
  RAYLOC_CHECK(values.material.size() == materials_.size());
  Scene::Input input{scene_->objects(), scene_->materials(), scene_->carrier_hz()};
  for (std::size_t i = 0; i < objects_.size(); i += 3) {
    const Vec3d by{values.translation[i], values.translation[i + 1], values.translation[i + 2]};
    for (Vec3d& vertex : input.objects[objects_[i].index].mesh.vertices) {
      vertex = vertex + by;
    }
  }
  for (std::size_t i = 0; i < materials_.size(); ++i) {
    RadioMaterial& material = input.materials[materials_[i].index];
    (materials_[i].kind == Kind::kConductivity ? material.conductivity
                                               : material.relative_permittivity) =
        values.material[i];
  }
  auto scene = Scene::create(std::move(input));
  RAYLOC_TRY(scene);
  return std::make_shared<const Scene>(std::move(*scene));
}

std::vector<RoomParameter> Parameters::describe(const Values& values) const {
  // Translations of an object, along the world's axes.
  static constexpr std::array kAxes = {
      Quantity::kTranslationX, Quantity::kTranslationY, Quantity::kTranslationZ};
  std::vector<RoomParameter> result;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const std::string& object = scene_->objects()[objects_[i].index].name;
    result.push_back({{values.translation[i], 0.0, 0.0}, {object, kAxes[i % 3]}, "m"});
  }
  const Values before = initial();
  for (std::size_t i = 0; i < materials_.size(); ++i) {
    const std::string& material = scene_->materials()[materials_[i].index].name;
    const bool conductivity = materials_[i].kind == Kind::kConductivity;
    result.push_back(
        {{values.material[i], before.material[i], 0.0},
         {material, conductivity ? Quantity::kConductivity : Quantity::kRelativePermittivity},
         conductivity ? "S/m" : "1"});
  }
  return result;
}

}  // namespace rayloc::paper
