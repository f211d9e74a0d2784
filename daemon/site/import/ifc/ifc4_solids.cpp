// Solids, profiles and representations whose form differs between IFC 4 and IFC 2x3.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/ifc/ifc4_shapes.h"
#include "daemon/site/import/ifc/row_of.h"
#include "engine/base/outline.h"

namespace rayloc {
namespace {

// Unread for the reason that `part` has, else for `type`.
Ifc4Shape unread(const Ifc4Shape& part, std::string_view type) {
  Ifc4Shape none;
  none.cause = part.cause.empty() ? type : part.cause;
  return none;
}

std::string_view type_of(const Ifc4Shapes& shapes, const StepEntity& entity) {
  return shapes.step().type(entity);
}

std::string_view type_of(const Ifc4Shapes& shapes, std::string_view reference) {
  const auto found = shapes.step().find(step_reference(reference));
  return found ? shapes.step().type(shapes.step().entities()[*found]) : "";
}

// assimp subtracts half-spaces and extruded solids from swept ones. Another cut is left out: the
// whole first operand remains, and the result counts as read in part.
Expected<Ifc4Shape> read_boolean(Ifc4Shapes& shapes,
                                 const StepEntity& entity,
                                 const IfcItems& items) {
  const auto first = shapes.read(items[1], entity, "IH");
  RAYLOC_TRY(first);
  const auto second = shapes.read(items[2], entity, "IH");
  RAYLOC_TRY(second);
  const std::string_view type = type_of(shapes, entity);
  if (first->id == 0 || first->kind != 'I') {
    return unread(*first, type);
  }
  const std::string_view body = type_of(shapes, items[1]);
  const std::string_view cut = type_of(shapes, items[2]);
  const bool is_body = body.starts_with("IFCBOOLEAN") || body == "IFCEXTRUDEDAREASOLID" ||
                       body == "IFCREVOLVEDAREASOLID";
  const bool is_cut = second->id != 0 && (second->kind == 'H' || cut == "IFCEXTRUDEDAREASOLID");
  Ifc4Shape made = *first;
  if (items[0] != ".DIFFERENCE." || !is_body || !is_cut) {
    made.cause = second->cause.empty() ? type : second->cause;
    return made;
  }
  shapes.add_as(
      entity, "IFCBOOLEANRESULT", fmt::format("(.DIFFERENCE.,#{},#{})", first->id, second->id));
  made.id = entity.id;
  made.cause = made.cause.empty() ? second->cause : made.cause;
  return made;
}

Expected<Ifc4Shape> read_csg(Ifc4Shapes& shapes, const StepEntity& entity, const IfcItems& items) {
  return shapes.read(items[0], entity, "I");
}

// Position, XLength, YLength, ZLength, from a corner.
Expected<Ifc4Shape> read_block(Ifc4Shapes& shapes,
                               const StepEntity& entity,
                               const IfcItems& items) {
  const auto position = shapes.read(items[0], entity, "A");
  RAYLOC_TRY(position);
  if (position->id == 0) {
    return unread(*position, "");
  }
  std::array<double, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto length = shapes.value(items[axis + 1], entity);
    RAYLOC_TRY(length);
    size[axis] = *length;
  }
  const auto add = [&](std::string_view type, const std::string& arguments) {
    return shapes.add(entity.line, type, arguments);
  };
  const auto centre =
      shapes.add_point(entity.line, std::array<double, 2>{0.5 * size[0], 0.5 * size[1]});
  const auto placement = add("IFCAXIS2PLACEMENT2D", fmt::format("(#{},$)", centre));
  const auto profile =
      add("IFCRECTANGLEPROFILEDEF",
          fmt::format("(.AREA.,$,#{},{:.15e},{:.15e})", placement, size[0], size[1]));
  const auto up = add("IFCDIRECTION", "((0.,0.,1.))");
  shapes.add_as(entity,
                "IFCEXTRUDEDAREASOLID",
                fmt::format("(#{},#{},#{},{:.15e})", profile, position->id, up, size[2]));
  Ifc4Shape made;
  made.is_swept = true;
  made.id = entity.id;
  return made;
}

// Directrix, Radius, InnerRadius, StartParam, EndParam. IFC 2x3 requires the parameters.
Expected<Ifc4Shape> read_swept_disk(Ifc4Shapes& shapes,
                                    const StepEntity& entity,
                                    const IfcItems& items) {
  const auto directrix = shapes.read(items[0], entity, "C");
  RAYLOC_TRY(directrix);
  const bool is_whole = items[3] == "$" && items[4] == "$";
  if (directrix->id == 0 || (is_whole && directrix->count < 2)) {
    return unread(*directrix, type_of(shapes, entity));
  }
  const auto radius = shapes.number(items[1], entity);
  RAYLOC_TRY(radius);
  std::string range = fmt::format("0.,{}.", directrix->count - 1);
  if (!is_whole) {
    const auto begin = shapes.number(items[3], entity);
    RAYLOC_TRY(begin);
    const auto end = shapes.number(items[4], entity);
    RAYLOC_TRY(end);
    range = *begin + "," + *end;
  }
  shapes.add_as(
      entity, "IFCSWEPTDISKSOLID", fmt::format("(#{},{},$,{})", directrix->id, *radius, range));
  Ifc4Shape made;
  made.id = entity.id;
  return made;
}

// The readable items of a representation: ContextOfItems, Identifier, Type, Items.
Expected<Ifc4Shape> read_representation(Ifc4Shapes& shapes,
                                        const StepEntity& entity,
                                        const IfcItems& items) {
  Ifc4Shape made;
  made.is_swept = true;
  std::vector<std::uint64_t> read;
  for (const std::string_view item : step_items(items[3])) {
    const auto one = shapes.read(item, entity, "");
    RAYLOC_TRY(one);
    const bool is_read = one->id != 0 && one->kind == 'I';
    const std::string_view cause = is_read ? one->cause : unread(*one, type_of(shapes, item)).cause;
    made.cause = made.cause.empty() ? cause : made.cause;
    if (is_read) {
      read.push_back(one->id);
      made.is_swept = made.is_swept && one->is_swept;
    }
  }
  if (read.empty()) {
    return unread(made, type_of(shapes, entity));
  }
  shapes.add_as(entity,
                "IFCSHAPEREPRESENTATION",
                fmt::format("({},'Body','SweptSolid',{})", shapes.context(), step_list(read)));
  made.id = entity.id;
  return made;
}

// Higher for a representation that shows the surfaces of an element; below 0 for lines and boxes.
int rank_of(std::string_view identifier) {
  constexpr std::array<std::string_view, 12> kNoSurfaces = {"Annotation",
                                                            "Axis",
                                                            "Box",
                                                            "Clearance",
                                                            "CoG",
                                                            "FootPrint",
                                                            "Lighting",
                                                            "Plan",
                                                            "Profile",
                                                            "Reference",
                                                            "Surface",
                                                            "SurveyPoints"};
  if (std::find(kNoSurfaces.begin(), kNoSurfaces.end(), identifier) != kNoSurfaces.end()) {
    return -1;
  }
  return identifier == "Body" ? 1 : 0;
}

// Name, Description, Representations: the best one that can be read.
Expected<Ifc4Shape> read_product_shape(Ifc4Shapes& shapes,
                                       const StepEntity& entity,
                                       const IfcItems& items) {
  std::vector<std::pair<int, std::string_view>> ranked;
  for (const std::string_view one : step_items(items[2])) {
    const auto found = shapes.step().find(step_reference(one));
    if (!found) {
      return shapes.refuse(entity,
                           fmt::format("has the representation {}, which does not exist", one));
    }
    const StepEntity& its = shapes.step().entities()[*found];
    const auto own = shapes.items_again(its, entity);
    RAYLOC_TRY(own);
    const int rank = own->size() > 1 ? rank_of(step_string((*own)[1])) : 0;
    if (rank >= 0) {
      ranked.emplace_back(rank, one);
    }
  }
  std::stable_sort(
      ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  Ifc4Shape made;
  for (const auto& [rank, one] : ranked) {
    auto read = shapes.read(one, entity, "R");
    RAYLOC_TRY(read);
    if (read->id != 0) {
      shapes.add_as(entity, "IFCPRODUCTDEFINITIONSHAPE", fmt::format("($,$,(#{}))", read->id));
      read->id = entity.id;
      return read;
    }
    made.cause = made.cause.empty() ? read->cause : made.cause;
  }
  // An element with lines alone has no surface to lose.
  made.cause = made.cause.empty() ? kNoIfc4Surface : made.cause;
  return made;
}

// The outlines of steel profiles with sharp edges, about the centre of their bounding box.
// `d`: the dimensions in the order of the file.
using Outline = std::vector<FloorPoint>;
using Dimensions = std::array<double, 4>;

Outline i_outline(const Dimensions& d) {
  const double x = 0.5 * d[0];
  const double y = 0.5 * d[1];
  const double web = 0.5 * d[2];
  const double in = y - d[3];
  return {{-x, -y},
          {x, -y},
          {x, -in},
          {web, -in},
          {web, in},
          {x, in},
          {x, y},
          {-x, y},
          {-x, in},
          {-web, in},
          {-web, -in},
          {-x, -in}};
}
Outline l_outline(const Dimensions& d) {
  const double x = 0.5 * (d[1] > 0.0 ? d[1] : d[0]);
  const double y = 0.5 * d[0];
  return {{-x, -y}, {x, -y}, {x, -y + d[2]}, {-x + d[2], -y + d[2]}, {-x + d[2], y}, {-x, y}};
}
Outline u_outline(const Dimensions& d) {
  const double x = 0.5 * d[1];
  const double y = 0.5 * d[0];
  return {{-x, -y},
          {x, -y},
          {x, -y + d[3]},
          {-x + d[2], -y + d[3]},
          {-x + d[2], y - d[3]},
          {x, y - d[3]},
          {x, y},
          {-x, y}};
}
Outline t_outline(const Dimensions& d) {
  const double x = 0.5 * d[1];
  const double y = 0.5 * d[0];
  const double web = 0.5 * d[2];
  return {{-web, -y},
          {web, -y},
          {web, y - d[3]},
          {x, y - d[3]},
          {x, y},
          {-x, y},
          {-x, y - d[3]},
          {-web, y - d[3]}};
}
Outline c_outline(const Dimensions& d) {
  const double x = 0.5 * d[1];
  const double y = 0.5 * d[0];
  const double t = d[2];
  return {{-x, -y},
          {x, -y},
          {x, -y + d[3]},
          {x - t, -y + d[3]},
          {x - t, -y + t},
          {-x + t, -y + t},
          {-x + t, y - t},
          {x - t, y - t},
          {x - t, y - d[3]},
          {x, y - d[3]},
          {x, y},
          {-x, y}};
}
Outline z_outline(const Dimensions& d) {
  const double y = 0.5 * d[0];
  const double web = 0.5 * d[2];
  const double x = d[1] - web;
  return {{-web, -y},
          {x, -y},
          {x, -y + d[3]},
          {web, -y + d[3]},
          {web, y},
          {-x, y},
          {-x, y - d[3]},
          {-web, y - d[3]}};
}
Outline trapezium_outline(const Dimensions& d) {
  const double x = 0.5 * d[0];
  const double y = 0.5 * d[2];
  return {{-x, -y}, {x, -y}, {-x + d[3] + d[1], y}, {-x + d[3], y}};
}

struct SteelProfile {
  std::string_view type;
  Outline (*outline)(const Dimensions&);
};
constexpr std::array kSteelProfiles = {SteelProfile{"IFCISHAPEPROFILEDEF", i_outline},
                                       SteelProfile{"IFCLSHAPEPROFILEDEF", l_outline},
                                       SteelProfile{"IFCUSHAPEPROFILEDEF", u_outline},
                                       SteelProfile{"IFCTSHAPEPROFILEDEF", t_outline},
                                       SteelProfile{"IFCCSHAPEPROFILEDEF", c_outline},
                                       SteelProfile{"IFCZSHAPEPROFILEDEF", z_outline},
                                       SteelProfile{"IFCTRAPEZIUMPROFILEDEF", trapezium_outline}};

// The numbers of the point or direction that is the attribute `index` of `from`; none for $.
Expected<std::vector<double>> numbers_of(const Ifc4Shapes& shapes,
                                         const StepEntity& from,
                                         std::size_t index) {
  std::vector<double> numbers;
  const IfcItems own = step_items(shapes.step().arguments(from));
  const auto found =
      index < own.size() ? shapes.step().find(step_reference(own[index])) : std::nullopt;
  if (!found) {
    return numbers;
  }
  const StepEntity& its = shapes.step().entities()[*found];
  const IfcItems attributes = step_items(shapes.step().arguments(its));
  for (const std::string_view one : attributes.empty() ? attributes : step_items(attributes[0])) {
    const auto number = shapes.value(one, its);
    RAYLOC_TRY(number);
    numbers.push_back(*number);
  }
  return numbers;
}

// Moves an outline to the IFCAXIS2PLACEMENT2D that `position` names.
Expected<void> place(Ifc4Shapes& shapes,
                     const StepEntity& entity,
                     std::string_view position,
                     Outline& outline) {
  if (position == "$") {
    return {};
  }
  RAYLOC_TRY(shapes.read(position, entity, "B"));
  const StepEntity& placement =
      shapes.step().entities()[*shapes.step().find(step_reference(position))];
  const auto at = numbers_of(shapes, placement, 0);
  RAYLOC_TRY(at);
  auto along = numbers_of(shapes, placement, 1);
  RAYLOC_TRY(along);
  if (along->size() < 2) {
    *along = {1.0, 0.0};
  }
  const double length = std::hypot((*along)[0], (*along)[1]);
  if (at->size() < 2 || !(length > 0.0)) {
    return shapes.refuse(placement, "has no point or direction in the plane");
  }
  const double c = (*along)[0] / length;
  const double s = (*along)[1] / length;
  for (FloorPoint& p : outline) {
    p = {c * p[0] - s * p[1] + (*at)[0], s * p[0] + c * p[1] + (*at)[1]};
  }
  return {};
}

// ProfileType, ProfileName, Position, four dimensions. assimp reads only the I, and places it off
// its centre.
Expected<Ifc4Shape> read_profile(Ifc4Shapes& shapes,
                                 const StepEntity& entity,
                                 const IfcItems& items) {
  constexpr std::size_t kFirst = 3;
  const SteelProfile* const type = row_of(kSteelProfiles, type_of(shapes, entity));
  Dimensions dimensions{};
  for (std::size_t i = 0; i < dimensions.size(); ++i) {
    // The width of an L may be left out, and its fourth number is the radius of its fillet.
    const std::string_view item = items[kFirst + i];
    if (type->outline == l_outline && item == "$" && i != 0 && i != 2) {
      continue;
    }
    const auto number = shapes.value(item, entity);
    RAYLOC_TRY(number);
    dimensions[i] = *number;
  }
  Outline outline = type->outline(dimensions);
  RAYLOC_TRY(place(shapes, entity, items[2], outline));
  outline.push_back(outline.front());
  std::vector<std::uint64_t> points;
  points.reserve(outline.size());
  for (const FloorPoint& p : outline) {
    points.push_back(shapes.add_point(entity.line, p));
  }
  const std::uint64_t curve = shapes.add(entity.line, "IFCPOLYLINE", "(" + step_list(points) + ")");
  shapes.add_as(entity, "IFCARBITRARYCLOSEDPROFILEDEF", fmt::format("(.AREA.,$,#{})", curve));
  Ifc4Shape made;
  made.id = entity.id;
  return made;
}

constexpr std::array kSolids = {
    Ifc4Special{"IFCBOOLEANRESULT", 'I', 3, read_boolean},
    Ifc4Special{"IFCBOOLEANCLIPPINGRESULT", 'I', 3, read_boolean},
    Ifc4Special{"IFCCSGSOLID", 'I', 1, read_csg},
    Ifc4Special{"IFCBLOCK", 'I', 4, read_block},
    Ifc4Special{"IFCSWEPTDISKSOLID", 'I', 5, read_swept_disk},
    Ifc4Special{"IFCSWEPTDISKSOLIDPOLYGONAL", 'I', 5, read_swept_disk},
    Ifc4Special{"IFCSHAPEREPRESENTATION", 'R', 4, read_representation},
    Ifc4Special{"IFCPRODUCTDEFINITIONSHAPE", 'Q', 3, read_product_shape},
    Ifc4Special{"IFCISHAPEPROFILEDEF", 'F', 7, read_profile},
    Ifc4Special{"IFCLSHAPEPROFILEDEF", 'F', 7, read_profile},
    Ifc4Special{"IFCUSHAPEPROFILEDEF", 'F', 7, read_profile},
    Ifc4Special{"IFCTSHAPEPROFILEDEF", 'F', 7, read_profile},
    Ifc4Special{"IFCCSHAPEPROFILEDEF", 'F', 7, read_profile},
    Ifc4Special{"IFCZSHAPEPROFILEDEF", 'F', 7, read_profile},
    Ifc4Special{"IFCTRAPEZIUMPROFILEDEF", 'F', 7, read_profile},
};

}  // namespace

const Ifc4Special* ifc4_solid(std::string_view type) { return row_of(kSolids, type); }

}  // namespace rayloc
