// DxfEntities: reads the drawn entities of a DXF file into blocks.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/site/import/drawing.h"
#include "daemon/site/import/dxf/dxf_curves.h"
#include "daemon/site/import/dxf/dxf_groups.h"

namespace rayloc {

// A block that is drawn within another one.
struct DxfInsert {
  std::string block;
  std::string layer;
  FloorPoint at{};
  double scale_x = 1.0;
  double scale_y = 1.0;
  double turn = 0.0;         // [rad]
  bool is_mirrored = false;  // at the y axis, after all others
  int columns = 1;           // of an array of the same block, rotated and not scaled
  int rows = 1;
  double column_step = 0.0;
  double row_step = 0.0;
};

struct DxfBlock {
  FloorPoint base{};
  std::vector<DrawnLine> lines;
  std::vector<DxfInsert> inserts;
  std::map<std::string, std::size_t> left_out;  // count by kind
  std::set<std::string> left_out_layers;        // layers of these
};

class DxfEntities {
 public:
  explicit DxfEntities(DxfGroups& groups) : groups_(groups) {}

  // Points of all entities that were read. Beyond kMaxDrawnPoints further ones are not kept.
  std::size_t points() const { return points_; }

  // Adds all entities up to the one named `end`, or to the end of the section or file.
  void read(std::string_view end, DxfBlock& to);

 private:
  // Groups that every entity may have.
  struct Common {
    std::string layer;
    bool is_on_sheet = false;  // in the layout of a sheet of paper
    bool is_invisible = false;
    double normal_z = 1.0;  // of the plane in which it is drawn; -1: seen from below
  };
  void read_common();
  void leave_out(const std::string& kind, DxfBlock& to) const;
  void keep(std::vector<FloorPoint> points, bool is_closed, DxfBlock& to);
  bool is_seen(DxfBlock& to) const;
  void keep_mirrored(std::vector<FloorPoint> points, bool is_closed, DxfBlock& to);

  void read_line(DxfBlock& to);
  void read_points(DxfBlock& to);
  std::optional<DxfVertex> read_vertex();
  void read_polyline(DxfBlock& to);
  void read_arc(const std::string& kind, DxfBlock& to);
  void read_insert(DxfBlock& to);

  DxfGroups& groups_;
  std::size_t points_ = 0;
  Common common_;  // of the entity that is read
};

}  // namespace rayloc
