// Points and lines by index, which IFC 2x3 does not have.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <system_error>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/ifc/ifc4_shapes.h"
#include "daemon/site/import/ifc/row_of.h"
#include "engine/base/vec3.h"

namespace rayloc {
namespace {

constexpr double kArcStep = std::numbers::pi / 18.0;  // [rad], chosen: 36 chords to a circle

// One point of IFC 2x3 for each: their ids follow one another.
Expected<Ifc4Shape> read_points(Ifc4Shapes& shapes,
                                const StepEntity& entity,
                                const IfcItems& items) {
  Ifc4Shape list;
  for (const std::string_view one : step_items(items[0])) {
    const auto text = shapes.coordinates(one, entity);
    RAYLOC_TRY(text);
    const std::uint64_t id = shapes.add(entity.line, "IFCCARTESIANPOINT", "(" + *text + ")");
    list.id = list.id == 0 ? id : list.id;
    IfcPoint at{};
    const IfcItems numbers = step_items(one);
    for (std::size_t axis = 0; axis < numbers.size(); ++axis) {
      at[axis] = *shapes.value(numbers[axis], entity);
    }
    shapes.points(list.id).push_back(at);
    ++list.count;
    RAYLOC_TRY(shapes.check_size(entity));
  }
  return list.id != 0 ? list : Expected<Ifc4Shape>(shapes.refuse(entity, "has no points"));
}

Expected<std::uint64_t> read_index(const Ifc4Shapes& shapes,
                                   const StepEntity& entity,
                                   std::string_view item,
                                   std::uint64_t count) {
  std::uint64_t index = 0;
  const auto read = std::from_chars(item.data(), item.data() + item.size(), index);
  if (read.ec != std::errc() || read.ptr != item.data() + item.size() || index == 0 ||
      index > count) {
    return shapes.refuse(entity,
                         fmt::format("has the index '{}' of {} points", clipped_step(item), count));
  }
  return index;
}

// Indices from 1 of the points of a list, and the list that redirects them ($: none).
class PointIndices {
 public:
  static Expected<PointIndices> read(Ifc4Shapes& shapes,
                                     const StepEntity& entity,
                                     std::string_view list,
                                     std::string_view redirected) {
    const auto points = shapes.read(list, entity, "Y");
    RAYLOC_TRY(points);
    PointIndices indices(*points);
    if (redirected == "$" || points->id == 0) {
      return indices;
    }
    for (const std::string_view one : step_items(redirected)) {
      const auto index = read_index(shapes, entity, one, points->count);
      RAYLOC_TRY(index);
      indices.redirected_.push_back(*index);
    }
    return indices;
  }

  const Ifc4Shape& points() const { return points_; }

  // The ids of the points of "(1,2,3)".
  Expected<std::vector<std::uint64_t>> ids(const Ifc4Shapes& shapes,
                                           const StepEntity& entity,
                                           std::string_view list) const {
    std::vector<std::uint64_t> ids;
    const std::uint64_t count = redirected_.empty() ? points_.count : redirected_.size();
    const IfcItems items = step_items(list);
    ids.reserve(items.size());
    for (const std::string_view item : items) {
      const auto index = read_index(shapes, entity, item, count);
      RAYLOC_TRY(index);
      const std::uint64_t at = redirected_.empty() ? *index : redirected_[*index - 1];
      ids.push_back(points_.id + at - 1);
    }
    return ids;
  }

 private:
  explicit PointIndices(const Ifc4Shape& points) : points_(points) {}

  Ifc4Shape points_;
  std::vector<std::uint64_t> redirected_;
};

// The points between `from` and `to` of the circle through the three; none if they are on a line.
std::vector<IfcPoint> points_of_arc(const IfcPoint& from, const IfcPoint& on, const IfcPoint& to) {
  const auto vector = [](const IfcPoint& p) { return Vec3d{p[0], p[1], p[2]}; };
  const Vec3d a = vector(on) - vector(from);
  const Vec3d b = vector(to) - vector(from);
  const Vec3d normal = cross(a, b);
  const double square = dot(normal, normal);
  std::vector<IfcPoint> points;
  // No size, or three points on a line.
  if (!(square > 1e-18 * dot(a, a) * dot(b, b))) {
    return points;
  }
  const Vec3d to_centre =
      (1.0 / (2.0 * square)) * (dot(b, b) * cross(normal, a) - dot(a, a) * cross(normal, b));
  const Vec3d centre = vector(from) + to_centre;
  const Vec3d first = vector(from) - centre;
  const Vec3d second = (1.0 / std::sqrt(square)) * cross(normal, first);
  const Vec3d last = vector(to) - centre;
  double angle = std::atan2(dot(last, second), dot(last, first));
  angle += angle <= 0.0 ? 2.0 * std::numbers::pi : 0.0;
  const int steps = std::max(1, static_cast<int>(std::ceil(angle / kArcStep - 1e-9)));
  points.reserve(static_cast<std::size_t>(steps));
  for (int i = 1; i < steps; ++i) {
    const double at = angle * i / steps;
    const Vec3d p = centre + std::cos(at) * first + std::sin(at) * second;
    points.push_back({p.x, p.y, p.z});
  }
  return points;
}

bool is_flat_list(const Ifc4Shapes& shapes, std::string_view list) {
  const auto found = shapes.step().find(step_reference(list));
  return found && shapes.step().type(shapes.step().entities()[*found]) == "IFCCARTESIANPOINTLIST2D";
}

// Appends the points of IFCLINEINDEX((1,2)) or IFCARCINDEX((1,2,3)).
Expected<void> append_segment(Ifc4Shapes& shapes,
                              const StepEntity& entity,
                              std::string_view segment,
                              const PointIndices& indices,
                              bool is_flat,
                              std::vector<std::uint64_t>& all) {
  const std::size_t list = std::min(segment.find('('), segment.size());
  const std::string_view kind = segment.substr(0, list);
  const IfcItems values = step_items(segment.substr(list));
  const bool is_arc = kind == "IFCARCINDEX";
  if ((!is_arc && kind != "IFCLINEINDEX") || values.size() != 1) {
    return shapes.refuse(entity, "has a segment that is neither IFCLINEINDEX nor IFCARCINDEX");
  }
  const auto ids = indices.ids(shapes, entity, values[0]);
  RAYLOC_TRY(ids);
  if (is_arc ? ids->size() != 3 : ids->size() < 2) {
    return shapes.refuse(entity, "has a segment with another number of points");
  }
  std::vector<std::uint64_t> own = *ids;
  if (is_arc) {
    const std::vector<IfcPoint>& at = shapes.points(indices.points().id);
    const std::uint64_t first = indices.points().id;
    const auto arc = points_of_arc(at[own[0] - first], at[own[1] - first], at[own[2] - first]);
    own = {own[0]};
    for (const IfcPoint& p : arc) {
      own.push_back(shapes.add_point(entity.line, std::span(p).first(is_flat ? 2 : 3)));
    }
    own.push_back(ids->back());
  }
  const bool continues = !all.empty() && all.back() == own.front();
  all.insert(all.end(), own.begin() + (continues ? 1 : 0), own.end());
  return shapes.check_size(entity);
}

Expected<Ifc4Shape> read_curve(Ifc4Shapes& shapes,
                               const StepEntity& entity,
                               const IfcItems& items) {
  const auto indices = PointIndices::read(shapes, entity, items[0], "$");
  RAYLOC_TRY(indices);
  Ifc4Shape curve = indices->points();
  if (curve.id == 0) {
    return curve;
  }
  std::vector<std::uint64_t> ids;
  if (items[1] == "$") {
    for (std::uint64_t i = 0; i < curve.count; ++i) {
      ids.push_back(curve.id + i);
    }
  }
  const bool is_flat = is_flat_list(shapes, items[0]);
  for (const std::string_view segment : step_items(items[1])) {
    RAYLOC_TRY(append_segment(shapes, entity, segment, *indices, is_flat, ids));
  }
  if (ids.size() < 2) {
    return shapes.refuse(entity, "has fewer than two points");
  }
  shapes.add_as(entity, "IFCPOLYLINE", "(" + step_list(ids) + ")");
  curve.id = entity.id;
  curve.count = static_cast<std::uint32_t>(ids.size());
  return curve;
}

// Adds a face with the outline and holes of these ids; 0 for a face without an area.
std::uint64_t add_face(Ifc4Shapes& shapes,
                       std::uint32_t line,
                       const std::vector<std::vector<std::uint64_t>>& loops) {
  std::vector<std::uint64_t> bounds;
  bounds.reserve(loops.size());
  for (std::vector<std::uint64_t> ids : loops) {
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    while (ids.size() > 1 && ids.front() == ids.back()) {
      ids.pop_back();
    }
    if (ids.size() < 3) {
      if (bounds.empty()) {
        return 0;
      }
      continue;
    }
    const std::uint64_t loop = shapes.add(line, "IFCPOLYLOOP", "(" + step_list(ids) + ")");
    bounds.push_back(shapes.add(line,
                                bounds.empty() ? "IFCFACEOUTERBOUND" : "IFCFACEBOUND",
                                fmt::format("(#{},.T.)", loop)));
  }
  return bounds.empty() ? 0 : shapes.add(line, "IFCFACE", "(" + step_list(bounds) + ")");
}

Expected<Ifc4Shape> add_surface(Ifc4Shapes& shapes,
                                const StepEntity& entity,
                                const std::vector<std::uint64_t>& faces) {
  Ifc4Shape made;
  if (faces.empty()) {
    made.cause = shapes.step().type(entity);
    return made;
  }
  const std::uint64_t set =
      shapes.add(entity.line, "IFCCONNECTEDFACESET", "(" + step_list(faces) + ")");
  shapes.add_as(entity, "IFCFACEBASEDSURFACEMODEL", fmt::format("((#{}))", set));
  made.id = entity.id;
  return made;
}

// IFC 4: Coordinates, Normals, Closed, CoordIndex, PnIndex. IFC 4.3 exchanges the second and third.
Expected<Ifc4Shape> read_triangles(Ifc4Shapes& shapes,
                                   const StepEntity& entity,
                                   const IfcItems& items) {
  const auto indices =
      PointIndices::read(shapes, entity, items[0], items.size() > 4 ? items[4] : "$");
  RAYLOC_TRY(indices);
  if (indices->points().id == 0) {
    return indices->points();
  }
  std::vector<std::uint64_t> faces;
  for (const std::string_view triangle : step_items(items[3])) {
    auto ids = indices->ids(shapes, entity, triangle);
    RAYLOC_TRY(ids);
    if (ids->size() != 3) {
      return shapes.refuse(entity, "has a triangle without three points");
    }
    if (const std::uint64_t face = add_face(shapes, entity.line, {*ids}); face != 0) {
      faces.push_back(face);
    }
    RAYLOC_TRY(shapes.check_size(entity));
  }
  return add_surface(shapes, entity, faces);
}

// The loops of an IFCINDEXEDPOLYGONALFACE, the outline first.
Expected<std::vector<std::vector<std::uint64_t>>> read_loops(Ifc4Shapes& shapes,
                                                             const StepEntity& entity,
                                                             std::string_view face,
                                                             const PointIndices& indices) {
  const auto found = shapes.step().find(step_reference(face));
  if (!found) {
    return shapes.refuse(entity, fmt::format("has the face {}, which does not exist", face));
  }
  const StepEntity& its = shapes.step().entities()[*found];
  const std::string_view type = shapes.step().type(its);
  const bool has_voids = type == "IFCINDEXEDPOLYGONALFACEWITHVOIDS";
  const auto read = shapes.items_again(its, entity);
  RAYLOC_TRY(read);
  const IfcItems& items = *read;
  if ((!has_voids && type != "IFCINDEXEDPOLYGONALFACE") || items.size() < (has_voids ? 2U : 1U)) {
    return shapes.refuse(its, fmt::format("is no face of #{}", entity.id));
  }
  IfcItems lists = {items[0]};
  if (has_voids) {
    const IfcItems inner = step_items(items[1]);
    lists.insert(lists.end(), inner.begin(), inner.end());
  }
  std::vector<std::vector<std::uint64_t>> loops;
  loops.reserve(lists.size());
  for (const std::string_view list : lists) {
    auto ids = indices.ids(shapes, its, list);
    RAYLOC_TRY(ids);
    loops.push_back(*std::move(ids));
  }
  return loops;
}

// Coordinates, Closed, Faces, PnIndex.
Expected<Ifc4Shape> read_polygons(Ifc4Shapes& shapes,
                                  const StepEntity& entity,
                                  const IfcItems& items) {
  const auto indices =
      PointIndices::read(shapes, entity, items[0], items.size() > 3 ? items[3] : "$");
  RAYLOC_TRY(indices);
  if (indices->points().id == 0) {
    return indices->points();
  }
  std::vector<std::uint64_t> faces;
  for (const std::string_view one : step_items(items[2])) {
    const auto loops = read_loops(shapes, entity, one, *indices);
    RAYLOC_TRY(loops);
    if (const std::uint64_t face = add_face(shapes, entity.line, *loops); face != 0) {
      faces.push_back(face);
    }
    RAYLOC_TRY(shapes.check_size(entity));
  }
  return add_surface(shapes, entity, faces);
}

constexpr std::array kIndexed = {
    Ifc4Special{"IFCCARTESIANPOINTLIST2D", 'Y', 1, read_points},
    Ifc4Special{"IFCCARTESIANPOINTLIST3D", 'Y', 1, read_points},
    Ifc4Special{"IFCINDEXEDPOLYCURVE", 'C', 2, read_curve},
    Ifc4Special{"IFCTRIANGULATEDFACESET", 'I', 4, read_triangles},
    Ifc4Special{"IFCTRIANGULATEDIRREGULARNETWORK", 'I', 4, read_triangles},
    Ifc4Special{"IFCPOLYGONALFACESET", 'I', 3, read_polygons},
};

}  // namespace

const Ifc4Special* ifc4_indexed(std::string_view type) { return row_of(kIndexed, type); }

}  // namespace rayloc
