#include "daemon/site/import/ifc/ifc_units.h"

#include <array>
#include <charconv>
#include <string_view>
#include <vector>

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

struct IfcUnit {
  std::string_view type;
  IfcAttributes attributes;
};

IfcUnit unit_of(const StepText& step, std::string_view reference) {
  const auto found = step.find(step_reference(reference));
  if (!found) {
    return {};
  }
  const StepEntity& entity = step.entities()[*found];
  return {step.type(entity), step_items(step.arguments(entity))};
}

// IFCLENGTHMEASURE(0.3048); 0 for another text.
double measure_of(std::string_view value) {
  const std::size_t list = value.find('(');
  const auto items =
      list == std::string_view::npos ? IfcAttributes{value} : step_items(value.substr(list));
  double number = 0.0;
  if (items.size() == 1) {
    std::from_chars(items[0].data(), items[0].data() + items[0].size(), number);
  }
  return number;
}

// The size of IFCCONVERSIONBASEDUNIT(Dimensions, UnitType, Name, ConversionFactor); 1 if unknown.
double converted_metres(const StepText& step, const IfcUnit& unit) {
  if (unit.attributes.size() < 4) {
    return 1.0;
  }
  const IfcUnit factor = unit_of(step, unit.attributes[3]);
  if (factor.type != "IFCMEASUREWITHUNIT" || factor.attributes.size() < 2) {
    return 1.0;
  }
  const double number = measure_of(factor.attributes[0]);
  const IfcUnit base = unit_of(step, factor.attributes[1]);
  if (base.type != "IFCSIUNIT" || base.attributes.size() < 3 || !(number > 0.0)) {
    return 1.0;
  }
  for (const SiPrefix& prefix : kLengthPrefixes) {
    if (base.attributes[2] == prefix.name) {
      return number * prefix.factor;
    }
  }
  return number;
}

}  // namespace

double ifc_metres(const StepText& step) {
  for (const StepEntity& entity : step.entities()) {
    if (step.type(entity) != "IFCUNITASSIGNMENT") {
      continue;
    }
    const auto items = step_items(step.arguments(entity));
    for (const std::string_view one : items.empty() ? items : step_items(items[0])) {
      const IfcUnit unit = unit_of(step, one);
      if (unit.type == "IFCCONVERSIONBASEDUNIT" && unit.attributes.size() > 1 &&
          unit.attributes[1] == kLength) {
        return converted_metres(step, unit);
      }
    }
  }
  return 1.0;
}

}  // namespace rayloc
