#include "daemon/site/import/dxf/dxf_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/dxf/dxf_entities.h"
#include "daemon/site/import/dxf/dxf_groups.h"
#include "daemon/site/import/listed.h"
#include "daemon/site/import/placing.h"
#include "daemon/site/import/utf8_text.h"

namespace rayloc {
namespace {

constexpr int kMaxBlockDepth = 16;  // blocks within blocks, chosen

constexpr double kSurveyFoot = 1200.0 / 3937.0;  // [m], of the US

// Metres per $INSUNITS number, for units of buildings; 0: not stated, or a unit of maps and stars.
constexpr std::array<double, 25> kDxfUnits = {0.0,
                                              0.0254,    // inch
                                              0.3048,    // foot
                                              1609.344,  // mile
                                              0.001,
                                              0.01,
                                              1.0,
                                              1000.0,
                                              2.54e-8,  // microinch
                                              2.54e-5,  // mil
                                              0.9144,   // yard
                                              0.0,
                                              0.0,
                                              1e-6,
                                              0.1,
                                              10.0,
                                              100.0,
                                              0.0,
                                              0.0,
                                              0.0,
                                              0.0,
                                              kSurveyFoot,
                                              kSurveyFoot / 12.0,
                                              kSurveyFoot * 3.0,
                                              kSurveyFoot * 5280.0};

// In points: a placed line has a copy of its layer's name, and each block is looked up by its name.
std::size_t points_of_name(const std::string& name) {
  constexpr std::size_t kUsualBytes = 64;  // chosen: names up to here count as none
  return name.size() <= kUsualBytes ? 0 : name.size() / sizeof(FloorPoint);
}

// Names of layers and blocks are compared without case.
struct Layer {
  std::string name;        // as in the table of layers
  bool is_frozen = false;  // hides what is inserted on it, too
  bool is_hidden = false;  // frozen or off
};

class DxfReader {
 public:
  explicit DxfReader(const std::filesystem::path& file) : file_(file.string()), groups_(file) {}

  Expected<Drawing> read() {
    while (!groups_.has_ended() && !groups_.is(0, "EOF")) {
      const bool begins = groups_.is(0, "SECTION");
      groups_.next();
      if (!begins) {
        continue;
      }
      if (groups_.is(2, "HEADER")) {
        read_header();
      } else if (groups_.is(2, "TABLES")) {
        read_each("LAYER", [this] { read_layer(); });
      } else if (groups_.is(2, "BLOCKS")) {
        read_each("BLOCK", [this] { read_block(); });
      } else if (groups_.is(2, "ENTITIES")) {
        groups_.next();
        entities_.read("ENDSEC", model_);
        is_cut_off_ = groups_.has_ended();
      }
    }
    if (!groups_.error().empty()) {
      return bad_input(groups_.error());
    }
    if (is_cut_off_) {
      return bad_input(
          fmt::format("{}:{}: the file ends within its entities, and others may be missing; export "
                      "or copy it again",
                      file_,
                      groups_.now().line));
    }
    place(model_, {}, "", 0);
    if (std::max(points_, entities_.points()) > kMaxDrawnPoints) {
      return bad_input(file_ + ": has more points than a plan of rooms; export one storey");
    }
    if (!is_finite_) {
      return bad_input(file_ + ": has a coordinate that is not a finite number; export it again");
    }
    sort_layers();
    if (groups_.has_windows_text()) {
      drawing_.remarks.emplace_back(
          "names of layers are not in UTF-8, and are read as Windows-1252 (Western Europe)");
    }
    if (const std::vector<std::string> left_out = counts(); !left_out.empty()) {
      drawing_.remarks.push_back("left out: " + listed(left_out));
    }
    return std::move(drawing_);
  }

 private:
  void read_header() {
    while (!groups_.has_ended() && !groups_.is(0, "ENDSEC")) {
      if (groups_.is(9, "$INSUNITS")) {
        groups_.next();
        const double unit = groups_.number();
        const bool is_listed = unit >= 0.0 && unit < static_cast<double>(kDxfUnits.size());
        drawing_.metres = is_listed ? kDxfUnits[static_cast<std::size_t>(unit)] : 0.0;
        if (drawing_.metres == 0.0 && unit != 0.0) {
          drawing_.remarks.push_back(fmt::format(
              "the unit of its header is ignored: $INSUNITS {:g} is no unit of buildings", unit));
        }
      }
      groups_.next();
    }
  }

  // Calls `read` at each record of that kind, up to the end of the section.
  template <typename Read>
  void read_each(std::string_view kind, const Read& read) {
    while (!groups_.has_ended() && !groups_.is(0, "ENDSEC")) {
      if (groups_.is(0, kind)) {
        groups_.next();
        read();
      } else {
        groups_.next();
      }
    }
  }

  void read_layer() {
    Layer layer;
    for (; !groups_.is_end(); groups_.next()) {
      switch (groups_.now().code) {
        case 2:
          layer.name = groups_.text();
          break;
        case 62:  // the colour
          layer.is_hidden = layer.is_hidden || groups_.integer() < 0;
          break;
        case 70:
          layer.is_frozen = (groups_.integer() & 1) != 0;
          layer.is_hidden = layer.is_hidden || layer.is_frozen;
          break;
        default:
          break;
      }
    }
    layers_[lower_case(layer.name)] = layer;
  }

  Layer layer_of(const std::string& name) const {
    const auto found = layers_.find(lower_case(name));
    return found == layers_.end() ? Layer{name} : found->second;
  }

  void read_block() {
    DxfBlock block;
    std::string name;
    for (; !groups_.is_end(); groups_.next()) {
      if (groups_.now().code == 2) {
        name = groups_.text();
      } else {
        groups_.read_point(10, block.base);
      }
    }
    entities_.read("ENDBLK", block);
    blocks_[lower_case(name)] = std::move(block);
  }

  // Lines of an inserted block; those of its layer "0" are on the layer of the insert.
  void place(const DxfBlock& block, const Placing& placing, const std::string& layer, int depth) {
    for (const DrawnLine& line : block.lines) {
      points_ += line.points.size() + points_of_name(layer) + points_of_name(line.layer);
      if (points_ > kMaxDrawnPoints) {
        return;
      }
      const Layer own = layer_of(line.layer == "0" && !layer.empty() ? layer : line.layer);
      DrawnLine placed{own.name, {}, line.is_closed};
      if (own.is_hidden) {
        drawing_.hidden_layers.insert(placed.layer);
        ++hidden_;
        continue;
      }
      used_.insert(placed.layer);
      placed.points.reserve(line.points.size());
      for (const FloorPoint& p : line.points) {
        placed.points.push_back(placing(p));
        is_finite_ = is_finite_ && std::isfinite(placed.points.back()[0]) &&
                     std::isfinite(placed.points.back()[1]);
      }
      drawing_.lines.push_back(std::move(placed));
    }
    for (const auto& [kind, count] : block.left_out) {
      points_ += 1 + points_of_name(kind);
    }
    for (const std::string& name : block.left_out_layers) {
      points_ += 1 + points_of_name(name);
    }
    if (points_ > kMaxDrawnPoints) {
      return;
    }
    for (const auto& [kind, count] : block.left_out) {
      left_out_[kind] += count;
    }
    for (const std::string& name : block.left_out_layers) {
      used_.insert(layer_of(name).name);
    }
    for (const DxfInsert& insert : block.inserts) {
      points_ += 1 + points_of_name(insert.block) + points_of_name(insert.layer);
      if (points_ > kMaxDrawnPoints) {
        return;
      }
      const auto found = blocks_.find(lower_case(insert.block));
      if (found == blocks_.end() || depth == kMaxBlockDepth) {
        ++left_out_[found == blocks_.end() ? "INSERT of a block that is not there"
                                           : "INSERT in too many blocks, or in itself"];
        continue;
      }
      const Layer own = layer_of(insert.layer == "0" && !layer.empty() ? layer : insert.layer);
      if (own.is_frozen) {
        drawing_.hidden_layers.insert(own.name);
        ++hidden_;
        continue;
      }
      place_array(insert, found->second, placing, own.name, depth + 1);
    }
  }

  void place_array(const DxfInsert& insert,
                   const DxfBlock& block,
                   const Placing& placing,
                   const std::string& layer,
                   int depth) {
    const Placing rotated = rotated_by(insert.turn);
    const Placing mirrored{insert.is_mirrored ? -1.0 : 1.0};
    for (int row = 0; row < insert.rows; ++row) {
      for (int column = 0; column < insert.columns; ++column) {
        if (++points_ > kMaxDrawnPoints) {
          return;
        }
        Placing own = rotated.after({insert.scale_x, 0.0, 0.0, insert.scale_y});
        const FloorPoint base = own(block.base);
        const FloorPoint step = rotated({insert.column_step * column, insert.row_step * row});
        own.x = insert.at[0] + step[0] - base[0];
        own.y = insert.at[1] + step[1] - base[1];
        place(block, placing.after(mirrored.after(own)), layer, depth);
      }
    }
  }

  void sort_layers() {
    for (const auto& [key, layer] : layers_) {
      if (!layer.is_hidden && !used_.contains(layer.name)) {
        drawing_.empty_layers.insert(layer.name);
      }
    }
  }

  std::vector<std::string> counts() const {
    std::vector<std::string> all;
    if (hidden_ > 0) {
      all.push_back(fmt::format(
          "{} on layers that are off or frozen ({})", hidden_, listed(drawing_.hidden_layers)));
    }
    for (const auto& [kind, count] : left_out_) {
      if (count > 0) {
        all.push_back(fmt::format("{} {}", count, kind));
      }
    }
    return all;
  }

  std::string file_;
  DxfGroups groups_;
  DxfEntities entities_{groups_};
  Drawing drawing_;
  DxfBlock model_;
  std::map<std::string, DxfBlock> blocks_;  // by name in lower case
  std::map<std::string, Layer> layers_;     // same
  std::set<std::string> used_;              // layers with a visible entity
  std::size_t hidden_ = 0;                  // lines and blocks on hidden layers
  std::map<std::string, std::size_t> left_out_;
  std::size_t points_ = 0;  // that were placed, and names in placed blocks
  bool is_cut_off_ = false;
  bool is_finite_ = true;
};

}  // namespace

Expected<Drawing> read_dxf(const std::filesystem::path& file) {
  auto drawing = DxfReader(file).read();
  if (drawing && drawing->lines.empty()) {
    return bad_input(fmt::format(
        "{}: has no line that can be seen{}{}; export the storey's plan as DXF, with its blocks",
        file.string(),
        drawing->remarks.empty() ? "" : ": ",
        fmt::join(drawing->remarks, "; ")));
  }
  return drawing;
}

}  // namespace rayloc
