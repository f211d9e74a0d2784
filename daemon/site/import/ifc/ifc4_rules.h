// Tables of IFC 4: the entities that a file of IFC 2x3 states as well, and their attributes there.
#pragma once

#include <string_view>

namespace rayloc {

// Kinds of entities: a reference to one of another kind is a fault of the file.
//   P point          D direction       V vector           X placement of an axis
//   A placement      B placement in the plane             T transformation  N local placement
//   C curve          G segment of a composite curve       F profile         U surface
//   I item of a shape                  H half-space       S shell           E face
//   O bound of a face                  L loop             M map             R representation
//   Q shape of a product               Y list of points  Z either placement
//
// `attributes`: two characters for each attribute of IFC 2x3.
//   #K reference to kind K             ?K same, or $
//   &K same as ?K; $ becomes the origin (K: A, B)
//   @K list of references, one or more
//   =. any value                       %. number          ^. enumeration: ".AREA.", ".T."
//   ~. list of 2 or 3 numbers          |. list of points and parameters
struct Ifc4Rule {
  std::string_view type;
  char kind;
  std::string_view attributes;
  std::string_view written;  // the type in IFC 2x3; empty: the same
};

// Null: the entity needs a conversion of its own, or is not read. Thread-safe.
const Ifc4Rule* ifc4_rule(std::string_view type);

// An element of a building or of its structure, with the attributes of IfcProduct and Tag.
struct Ifc4Product {
  std::string_view type;
  std::string_view written;  // the type in IFC 2x3; empty: the same
  std::string_view rest;     // attributes of IFC 2x3 behind the eighth, with a comma before each
};

// Null: an element without a row, for which IFC 2x3 has IfcBuildingElementProxy. Thread-safe.
const Ifc4Product* ifc4_product(std::string_view type);

// True for a product without surfaces in the room: axes, annotations, zones, ports. Thread-safe.
bool is_immaterial_ifc4(std::string_view type);

// "profile", for messages.
std::string_view name_of_ifc4_kind(char kind);

}  // namespace rayloc
