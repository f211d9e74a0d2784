#include "daemon/site/scene/plan_materials.h"

#include <algorithm>
#include <span>

#include "engine/base/suggestion.h"

namespace rayloc {

PlanMaterials::PlanMaterials(const TomlTable& root, double carrier_hz) : carrier_hz_(carrier_hz) {
  for (const auto& [name, table] : root.named_tables("materials")) {
    declared_.push_back({read(name, table), table});
  }
}

std::optional<std::string> PlanMaterials::use(const TomlTable& table, std::string_view key) {
  std::optional<std::string> name = table.string(key);
  if (!name || in_use_.contains(*name)) {
    return name;
  }
  const bool declared = std::any_of(declared_.begin(), declared_.end(), [&](const Declared& one) {
    return one.material.name == *name;
  });
  if (!declared) {
    StatedMaterial material;
    material.name = *name;
    material.itu = *name;
    if (const auto valid = evaluate(material); !valid) {
      table.error_at(key, "'" + std::string(key) + "': " + refusal(*name, valid.error()));
      unknown_name_ = true;
      return std::nullopt;
    }
    declared_.push_back({material, table});
  }
  in_use_.insert(*name);
  return name;
}

std::vector<StatedMaterial> PlanMaterials::finish() const {
  std::vector<StatedMaterial> used;
  for (const Declared& one : declared_) {
    if (in_use_.contains(one.material.name)) {
      used.push_back(one.material);
    } else if (!unknown_name_) {
      one.table.error("material '" + one.material.name +
                      "' is not used; name it in a wall, floor, ceiling, opening or box, or "
                      "remove it");
    }
  }
  std::sort(used.begin(), used.end(), [](const StatedMaterial& a, const StatedMaterial& b) {
    return a.name < b.name;
  });
  return used;
}

StatedMaterial PlanMaterials::read(const std::string& name, const TomlTable& table) const {
  StatedMaterial out;
  out.name = name;
  out.thickness = table.number("thickness_m", {1e-5, 10.0, "m"}).value_or(kDefaultThickness);
  const auto permittivity = table.number("relative_permittivity", {1.0, 1e4});
  const auto conductivity = table.number("conductivity", {0.0, 1e9, "S/m"});
  const std::optional<std::string> itu = table.string("itu");
  if (!is_object_name(name)) {
    table.error("material '" + name + "': write letters, digits, '-' and '_' only");
    return out;
  }
  if (table.has("relative_permittivity") || table.has("conductivity")) {
    if (table.has("itu")) {
      table.error("material '" + name +
                  "' states 'itu' and numbers of its own; write one or the other");
    }
    table.require({{"relative_permittivity", "relative_permittivity = 2.7"},
                   {"conductivity", "conductivity = 0.01"}});
    out.relative_permittivity = permittivity.value_or(1.0);
    out.conductivity = conductivity.value_or(0.0);
    return out;
  }
  out.itu = itu.value_or(name);
  if (const auto valid = evaluate(out); !valid) {
    table.error_at("itu", "material '" + name + "': " + refusal(out.itu, valid.error()));
  }
  return out;
}

Expected<RadioMaterial> PlanMaterials::evaluate(const StatedMaterial& material) const {
  return itu_material(material.itu, carrier_hz_, material.thickness);
}

std::string PlanMaterials::refusal(const std::string& name, const Error& error) const {
  const auto itu = itu_material_names();
  if (std::find(itu.begin(), itu.end(), name) != itu.end()) {
    return error.message;
  }
  std::vector<std::string> known(itu.begin(), itu.end());
  for (const Declared& one : declared_) {
    known.push_back(one.material.name);
  }
  return "neither ITU-R P.2040-4 nor [materials] has '" + name + "'" +
         suggestion(name, std::span<const std::string>(known));
}

}  // namespace rayloc
