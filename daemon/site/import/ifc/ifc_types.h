// The types of IFC 2x3 (ISO/PAS 16739), and the relations of wholes and parts.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace rayloc {

// `type` in capitals: "IFCWALL". Thread-safe.
bool is_ifc2x3_type(std::string_view type);

// Relations that assimp follows from an element to its parts: the place of the whole and of the
// parts among their attributes, which are the same in IFC 4.
struct IfcPartsRelation {
  std::string_view type;
  std::size_t whole;
  std::size_t parts;
};
inline constexpr std::array kIfcPartsRelations = {
    IfcPartsRelation{"IFCRELAGGREGATES", 4, 5},
    IfcPartsRelation{"IFCRELCONTAINEDINSPATIALSTRUCTURE", 5, 4},
    IfcPartsRelation{"IFCRELVOIDSELEMENT", 4, 5}};

}  // namespace rayloc
