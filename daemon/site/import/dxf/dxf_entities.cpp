#include "daemon/site/import/dxf/dxf_entities.h"

#include <utility>

#include "engine/base/constants.h"

namespace rayloc {
namespace {

constexpr const char* kArc = "arcs of polylines, of which the chords were taken";

}  // namespace

// The current group, if it is one of those.
void DxfEntities::read_common() {
  switch (groups_.now().code) {
    case 8:
      common_.layer = groups_.now().value;
      break;
    case 60:
      common_.is_invisible = groups_.integer() != 0;
      break;
    case 67:
      common_.is_on_sheet = groups_.integer() != 0;
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
  return true;
}

void DxfEntities::keep(DrawnLine&& line, DxfBlock& to) const {
  if (line.points.size() > 1 && is_seen(to)) {
    line.layer = common_.layer;
    to.lines.push_back(std::move(line));
  }
}

void DxfEntities::read(std::string_view end, DxfBlock& to) {
  while (!groups_.has_ended() && !groups_.is(0, end) && !groups_.is(0, "ENDSEC")) {
    if (groups_.now().code != 0) {
      groups_.next();
      continue;
    }
    const std::string kind = groups_.now().value;
    groups_.next();
    common_ = {};
    if (kind == "LINE") {
      read_line(to);
    } else if (kind == "LWPOLYLINE") {
      read_points(to);
    } else if (kind == "POLYLINE") {
      read_polyline(to);
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
  DrawnLine line;
  line.points.resize(2);
  for (; !groups_.is_end(); groups_.next()) {
    switch (groups_.now().code) {
      case 10:
        line.points[0][0] = groups_.number();
        break;
      case 20:
        line.points[0][1] = groups_.number();
        break;
      case 11:
        line.points[1][0] = groups_.number();
        break;
      case 21:
        line.points[1][1] = groups_.number();
        break;
      default:
        read_common();
        break;
    }
  }
  keep(std::move(line), to);
}

// Consecutive points of an LWPOLYLINE.
void DxfEntities::read_points(DxfBlock& to) {
  DrawnLine line;
  for (; !groups_.is_end(); groups_.next()) {
    switch (groups_.now().code) {
      case 42:
        to.left_out[kArc] += groups_.number() != 0.0 ? 1U : 0U;
        break;
      case 70:
        line.is_closed = (groups_.integer() & 1) != 0;
        break;
      case 10:
        line.points.push_back({groups_.number(), 0.0});
        break;
      case 20:
        if (!line.points.empty()) {
          line.points.back()[1] = groups_.number();
        }
        break;
      default:
        read_common();
        break;
    }
  }
  keep(std::move(line), to);
}

// Points of a POLYLINE, which are separate entities.
void DxfEntities::read_polyline(DxfBlock& to) {
  DrawnLine line;
  for (; !groups_.is_end(); groups_.next()) {
    if (groups_.now().code == 70) {
      line.is_closed = (groups_.integer() & 1) != 0;
    }
    read_common();
  }
  while (groups_.is(0, "VERTEX")) {
    FloorPoint point{};
    for (groups_.next(); !groups_.is_end(); groups_.next()) {
      if (groups_.now().code == 10) {
        point[0] = groups_.number();
      } else if (groups_.now().code == 20) {
        point[1] = groups_.number();
      }
    }
    line.points.push_back(point);
  }
  keep(std::move(line), to);
}

void DxfEntities::read_insert(DxfBlock& to) {
  DxfInsert insert;
  for (; !groups_.is_end(); groups_.next()) {
    switch (groups_.now().code) {
      case 2:
        insert.block = groups_.now().value;
        break;
      case 10:
        insert.at[0] = groups_.number();
        break;
      case 20:
        insert.at[1] = groups_.number();
        break;
      case 41:
        insert.scale_x = groups_.number();
        break;
      case 42:
        insert.scale_y = groups_.number();
        break;
      case 50:
        insert.turn = groups_.number() * kDegree;
        break;
      default:
        read_common();
        break;
    }
  }
  insert.layer = common_.layer;
  if (is_seen(to)) {
    to.inserts.push_back(std::move(insert));
  }
}

}  // namespace rayloc
