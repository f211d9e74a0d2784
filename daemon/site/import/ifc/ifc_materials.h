// Names and materials of the elements of an IFC file, which assimp does not report.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>

#include "daemon/site/import/ifc/step_text.h"

namespace rayloc {

inline constexpr std::size_t kIfcGlobalId = 22;  // its characters

struct IfcElement {
  std::string name;  // UTF-8; may be empty
  // Of the element; otherwise of its type; otherwise of the assembly; may be empty.
  std::string material;
};

// By the GlobalId of the element, of IFC 2x3 or IFC 4. A list of materials or profiles counts as
// its first, layers as the thickest one, constituents as that of the largest fraction (the first of
// equal ones). Thread-safe. References in `step` need not be valid.
std::map<std::string, IfcElement, std::less<>> ifc_elements(const StepText& step);

}  // namespace rayloc
