#include "daemon/site/import/dxf/dxf_entities.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/constants.h"

namespace rayloc {
namespace {

constexpr double kLevel = 0.999;  // cosine, chosen: 2.6 degrees
// Flags of a POLYLINE and of its vertices.
constexpr int kIsClosed = 1;
constexpr int kIsSpatial = 8;
constexpr int kIsMesh = 16 | 64;
constexpr int kIsSplineFrame = 16;

}  // namespace

// The current group, if it is one of those.
void DxfEntities::read_common() {
  switch (groups_.now().code) {
    case 8:
      common_.layer = groups_.text();
      break;
    case 60:
      common_.is_invisible = groups_.integer() != 0;
      break;
    case 67:
      common_.is_on_sheet = groups_.integer() != 0;
      break;
    case 230:
      common_.normal_z = groups_.number();
      break;
    default:
      break;
  }
}

void DxfEntities::leave_out(const std::string& kind, DxfBlock& to) const {
  ++to.left_out[kind];
  to.left_out_layers.insert(common_.layer);
}

// False, and counted, for an entity that a person does not see in the plan.
bool DxfEntities::is_seen(DxfBlock& to) const {
  if (common_.is_on_sheet || common_.is_invisible) {
    leave_out(common_.is_on_sheet ? "in the layout of a sheet" : "invisible", to);
    return false;
  }
  if (std::abs(common_.normal_z) < kLevel) {
    leave_out("in a plane that is not level", to);
    return false;
  }
  return true;
}

void DxfEntities::keep(std::vector<FloorPoint> points, bool is_closed, DxfBlock& to) {
  points_ += points.size();
  if (points_ > kMaxDrawnPoints || !is_seen(to)) {
    return;
  }
  if (points.size() < 2) {
    leave_out("line without a second point", to);
    return;
  }
  to.lines.push_back({common_.layer, std::move(points), is_closed});
}

void DxfEntities::read(std::string_view end, DxfBlock& to) {
  while (!groups_.has_ended() && !groups_.is(0, end) && !groups_.is(0, "ENDSEC") &&
         !groups_.is(0, "EOF")) {
    if (groups_.now().code != 0) {
      groups_.next();
      continue;
    }
    const std::string kind = groups_.text();
    groups_.next();
    common_ = {};
    if (kind == "LINE") {
      read_line(to);
    } else if (kind == "LWPOLYLINE") {
      read_points(to);
    } else if (kind == "POLYLINE") {
      read_polyline(to);
    } else if (kind == "ARC" || kind == "CIRCLE" || kind == "ELLIPSE") {
      read_arc(kind, to);
    } else if (kind == "INSERT") {
      read_insert(to);
    } else if (kind != "ATTRIB" && kind != "SEQEND") {
      for (; !groups_.is_end(); groups_.next()) {
        read_common();
      }
      leave_out(kind, to);
    }
  }
}

void DxfEntities::read_line(DxfBlock& to) {
  std::vector<FloorPoint> points(2);
  for (; !groups_.is_end(); groups_.next()) {
    if (!groups_.read_point(10, points[0]) && !groups_.read_point(11, points[1])) {
      read_common();
    }
  }
  common_.normal_z = 1.0;  // its ends are those of the drawing, whatever its plane
  keep(std::move(points), false, to);
}

// For entities whose x axis is that of their own plane, which points back if seen from below.
void DxfEntities::keep_mirrored(std::vector<FloorPoint> points, bool is_closed, DxfBlock& to) {
  if (common_.normal_z < 0.0) {
    for (FloorPoint& p : points) {
      p[0] = -p[0];
    }
  }
  keep(std::move(points), is_closed, to);
}

// Consecutive points of an LWPOLYLINE.
void DxfEntities::read_points(DxfBlock& to) {
  std::vector<DxfVertex> vertices;
  bool is_closed = false;
  for (; !groups_.is_end(); groups_.next()) {
    switch (groups_.now().code) {
      case 70:
        is_closed = (groups_.integer() & kIsClosed) != 0;
        break;
      case 10:
        vertices.push_back({{groups_.number(), 0.0}});
        break;
      case 20:
        if (!vertices.empty()) {
          vertices.back().at[1] = groups_.number();
        }
        break;
      case 42:
        if (!vertices.empty()) {
          vertices.back().bulge = groups_.number();
        }
        break;
      default:
        read_common();
        break;
    }
  }
  keep_mirrored(corners_of(vertices, is_closed), is_closed, to);
}

// Empty for a control point of a spline, which is not on the line.
std::optional<DxfVertex> DxfEntities::read_vertex() {
  DxfVertex vertex;
  bool is_on_line = true;
  for (groups_.next(); !groups_.is_end(); groups_.next()) {
    switch (groups_.now().code) {
      case 42:
        vertex.bulge = groups_.number();
        break;
      case 70:
        is_on_line = (groups_.integer() & kIsSplineFrame) == 0;
        break;
      default:
        groups_.read_point(10, vertex.at);
        break;
    }
  }
  return is_on_line ? std::optional(vertex) : std::nullopt;
}

// Points of a POLYLINE, which are separate entities.
void DxfEntities::read_polyline(DxfBlock& to) {
  int flags = 0;
  for (; !groups_.is_end(); groups_.next()) {
    if (groups_.now().code == 70) {
      flags = groups_.integer();
    }
    read_common();
  }
  std::vector<DxfVertex> vertices;
  while (groups_.is(0, "VERTEX")) {
    if (const auto vertex = read_vertex()) {
      vertices.push_back(*vertex);
    }
  }
  if ((flags & kIsMesh) != 0) {
    leave_out("POLYLINE that is a mesh", to);
    return;
  }
  if ((flags & kIsSpatial) != 0) {
    common_.normal_z = 1.0;  // its points are those of the drawing, whatever its plane
  }
  const bool is_closed = (flags & kIsClosed) != 0;
  keep_mirrored(corners_of(vertices, is_closed), is_closed, to);
}

// A CIRCLE and an ARC have a radius and angles in degrees, an ELLIPSE has its major axis and angles
// in radians.
void DxfEntities::read_arc(const std::string& kind, DxfBlock& to) {
  DxfArc arc;
  const double angle = kind == "ARC" ? kDegree : 1.0;
  for (; !groups_.is_end(); groups_.next()) {
    switch (groups_.now().code) {
      case 40:
        (kind == "ELLIPSE" ? arc.ratio : arc.major[0]) = groups_.number();
        break;
      case 41:
      case 50:
        arc.begin = angle * groups_.number();
        break;
      case 42:
      case 51:
        arc.end = angle * groups_.number();
        break;
      default:
        if (!groups_.read_point(10, arc.centre) && !groups_.read_point(11, arc.major)) {
          read_common();
        }
        break;
    }
  }
  if (kind == "ELLIPSE") {
    // Its centre and axis are those of the drawing.
    arc.ratio = common_.normal_z < 0.0 ? -arc.ratio : arc.ratio;
    keep(points_of(arc), is_whole(arc), to);
  } else {
    keep_mirrored(points_of(arc), is_whole(arc), to);
  }
}

void DxfEntities::read_insert(DxfBlock& to) {
  DxfInsert insert;
  for (; !groups_.is_end(); groups_.next()) {
    switch (groups_.now().code) {
      case 2:
        insert.block = groups_.text();
        break;
      case 41:
        insert.scale_x = groups_.number();
        break;
      case 42:
        insert.scale_y = groups_.number();
        break;
      case 44:
        insert.column_step = groups_.number();
        break;
      case 45:
        insert.row_step = groups_.number();
        break;
      case 50:
        insert.turn = groups_.number() * kDegree;
        break;
      case 70:
        insert.columns = std::max(1, groups_.integer());
        break;
      case 71:
        insert.rows = std::max(1, groups_.integer());
        break;
      default:
        if (!groups_.read_point(10, insert.at)) {
          read_common();
        }
        break;
    }
  }
  insert.layer = common_.layer;
  insert.is_mirrored = common_.normal_z < 0.0;
  if (is_seen(to)) {
    to.inserts.push_back(std::move(insert));
  }
}

}  // namespace rayloc
