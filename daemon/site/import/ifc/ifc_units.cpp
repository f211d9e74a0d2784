#include "daemon/site/import/ifc/ifc_units.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "engine/base/number_text.h"

namespace rayloc {
namespace {

using IfcAttributes = std::vector<std::string_view>;

constexpr std::string_view kLength = ".LENGTHUNIT.";

struct SiPrefix {
  std::string_view name;
  double factor;
};
constexpr std::array kLengthPrefixes = {SiPrefix{".MILLI.", 1e-3},
                                        SiPrefix{".CENTI.", 1e-2},
                                        SiPrefix{".DECI.", 1e-1},
                                        SiPrefix{".KILO.", 1e3}};

// Empty if the entity is of another type.
IfcAttributes attributes_of(const StepText& step, std::uint64_t id, std::string_view type) {
  const auto found = step.find(id);
  if (!found || step.type(step.entities()[*found]) != type) {
    return {};
  }
  return step_items(step.arguments(step.entities()[*found]));
}

// The size of IFCCONVERSIONBASEDUNIT(Dimensions, UnitType, Name, ConversionFactor); 1 if unknown.
double converted_metres(const StepText& step, const IfcAttributes& unit) {
  if (unit.size() < 4) {
    return 1.0;
  }
  const auto factor = attributes_of(step, step_reference(unit[3]), "IFCMEASUREWITHUNIT");
  if (factor.size() < 2) {
    return 1.0;
  }
  const auto base = attributes_of(step, step_reference(factor[1]), "IFCSIUNIT");
  if (base.size() < 3) {
    return 1.0;
  }
  double metres = ifc_measure(factor[0]);
  for (const SiPrefix& prefix : kLengthPrefixes) {
    if (base[2] == prefix.name) {
      metres *= prefix.factor;
    }
  }
  return std::isfinite(metres) && metres > 0.0 ? metres : 1.0;
}

}  // namespace

double ifc_metres(const StepText& step) {
  std::unordered_set<std::uint64_t> visited;
  for (const StepEntity& entity : step.entities()) {
    if (step.type(entity) != "IFCUNITASSIGNMENT") {
      continue;
    }
    const auto items = step_items(step.arguments(entity));
    for (const std::string_view one : items.empty() ? items : step_items(items[0])) {
      const std::uint64_t id = step_reference(one);
      if (!visited.insert(id).second) {
        continue;
      }
      const auto unit = attributes_of(step, id, "IFCCONVERSIONBASEDUNIT");
      if (unit.size() > 1 && unit[1] == kLength) {
        return converted_metres(step, unit);
      }
    }
  }
  return 1.0;
}

double ifc_measure(std::string_view value) {
  const std::size_t list = value.find('(');
  const auto items =
      list == std::string_view::npos ? IfcAttributes{value} : step_items(value.substr(list));
  if (items.size() != 1) {
    return 0.0;
  }
  std::string_view text = items[0];
  const std::optional<double> number = read_number(text);
  return number && text.empty() ? *number : 0.0;
}

}  // namespace rayloc
