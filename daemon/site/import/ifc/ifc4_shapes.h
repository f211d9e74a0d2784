// Ifc4Shapes: shapes of an IFC 4 file as entities of IFC 2x3.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "daemon/site/import/ifc/ifc4_rules.h"
#include "daemon/site/import/ifc/step_text.h"
#include "engine/base/expected.h"

namespace rayloc {

// The cause of a shape without surfaces, which is not missed.
inline constexpr std::string_view kNoIfc4Surface = "no surface";

struct Ifc4Shape {
  std::uint64_t id = 0;     // in the text of IFC 2x3; 0: not read
  char kind = '\0';         // as in ifc4_rules.h; 0: unknown
  bool is_open = false;     // being read
  bool is_swept = false;    // by assimp's extrusion, from which it cuts openings
  std::uint32_t count = 0;  // of the points of a polyline or of a list of points
  // The type in the file for which this is not read, or only in part; empty: all is read.
  std::string_view cause;
};

using IfcItems = std::vector<std::string_view>;
using IfcPoint = std::array<double, 3>;

// "(#1,#2)".
std::string step_list(const std::vector<std::uint64_t>& ids);

class Ifc4Shapes {
 public:
  // `step` and `file`, its name, outlive this.
  Ifc4Shapes(const StepText& step, const std::string& file);

  // The shape that `reference` of `from` names, with all that it refers to; each entity is read
  // once. `kinds`: those that fit there; empty: any. An Error (kBadInput) has the file, the line
  // and the entity: a reference to nothing or to another kind, a cycle, an attribute of another
  // kind, an index beyond a list, or a text of more than 256 MiB.
  Expected<Ifc4Shape> read(std::string_view reference,
                           const StepEntity& from,
                           std::string_view kinds);
  Expected<std::string> number(std::string_view item, const StepEntity& from) const;  // "5."
  Expected<double> value(std::string_view item, const StepEntity& from) const;
  // "(0.,1.)", of 2 or 3 numbers.
  Expected<std::string> coordinates(std::string_view item, const StepEntity& from) const;

  // Adds an entity of IFC 2x3 with a new id, which is returned.
  std::uint64_t add(std::uint32_t line, std::string_view type, std::string_view arguments);
  // A point of two or three coordinates.
  std::uint64_t add_point(std::uint32_t line, std::span<const double> at);
  // With its id in the file: a style may refer to it.
  void add_as(const StepEntity& entity, std::string_view type, std::string_view arguments) {
    out_.add(entity.id, entity.line, type, arguments);
  }
  // "#7": the placement at the origin; kind A or B.
  std::string origin(char kind);
  // "#8": the one context of all representations. `placement`: of its coordinates; 0: the origin.
  void set_context(std::uint64_t placement);
  const std::string& context() const { return context_; }
  std::vector<IfcPoint>& points(std::uint64_t list) { return points_[list]; }

  const StepText& step() const { return step_; }
  // The shape of an entity of the file; an id of 0 if it is not read.
  const Ifc4Shape& shape(std::size_t index) const { return shapes_[index]; }
  StepText finish() { return out_.finish(); }

  Expected<void> check_size(const StepEntity& entity) const;
  // The attributes of an entity that `from` refers to and that is read again for each reference: an
  // Error if long ones are read too often.
  Expected<IfcItems> items_again(const StepEntity& entity, const StepEntity& from);
  tl::unexpected<Error> refuse(const StepEntity& entity, const std::string& what) const;

 private:
  Expected<Ifc4Shape> convert(const StepEntity& entity);
  Expected<Ifc4Shape> by_rule(const StepEntity& entity,
                              const IfcItems& items,
                              const Ifc4Rule& rule);
  Expected<Ifc4Shape> attribute(std::string_view code,
                                std::string_view item,
                                const StepEntity& from,
                                std::string& out);
  Expected<Ifc4Shape> reference(std::string_view code,
                                std::string_view item,
                                const StepEntity& from,
                                std::string& out);
  Expected<std::string> trims(std::string_view item, const StepEntity& from);

  const StepText& step_;
  const std::string& file_;
  StepWriter out_;
  std::vector<Ifc4Shape> shapes_;                                    // by the index of the entity
  std::unordered_map<std::uint64_t, std::vector<IfcPoint>> points_;  // by the id of their list
  std::uint64_t next_id_ = 1;
  std::uint32_t depth_ = 0;
  std::uint64_t read_again_ = 0;  // [bytes]
  std::array<std::string, 2> origins_;
  std::string context_;
};

// Reads an entity that IFC 2x3 does not have, or has in another form. `items`: its attributes.
using Ifc4Reader = Expected<Ifc4Shape> (*)(Ifc4Shapes& shapes,
                                           const StepEntity& entity,
                                           const IfcItems& items);

struct Ifc4Special {
  std::string_view type;
  char kind;
  std::size_t attributes;  // that are needed
  Ifc4Reader read;
};

// Points and lines by index: lists of points, curves, sets of triangles and polygons.
const Ifc4Special* ifc4_indexed(std::string_view type);
// Solids, outlines of steel profiles and the choice of a representation.
const Ifc4Special* ifc4_solid(std::string_view type);

}  // namespace rayloc
