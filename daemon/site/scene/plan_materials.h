// PlanMaterials: the materials that a room plan declares ([materials.NAME]) and uses.
//
// Errors are noted in the plan's document (toml_reader.h). Only room_plan.cpp uses this.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/site/model/toml_reader.h"
#include "daemon/site/scene/scene_files.h"
#include "engine/base/expected.h"
#include "engine/em/radio_material.h"

namespace rayloc {

class PlanMaterials {
 public:
  // Reads [materials]; rows of the ITU table must cover `carrier_hz`.
  PlanMaterials(const TomlTable& root, double carrier_hz);

  // The name of a material under `key`, marked as used; empty if absent or unknown.
  std::optional<std::string> use(const TomlTable& table, std::string_view key);

  // The used materials, by name; notes an error at each declared one that is unused, except for
  // plans with an unknown name, which may be a misspelt one.
  std::vector<StatedMaterial> finish() const;

 private:
  struct Declared {
    StatedMaterial material;
    TomlTable table;
  };

  StatedMaterial read(const std::string& name, const TomlTable& table) const;
  Expected<RadioMaterial> evaluate(const StatedMaterial& material) const;
  // The error of the ITU table; for an unknown name, the message lists the plan's own materials.
  std::string refusal(const std::string& name, const Error& error) const;

  double carrier_hz_;
  std::vector<Declared> declared_;
  std::set<std::string> in_use_;
  bool unknown_name_ = false;
};

}  // namespace rayloc
