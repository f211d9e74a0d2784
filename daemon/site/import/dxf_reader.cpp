#include "daemon/site/import/dxf_reader.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/placing.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

constexpr int kMaxBlockDepth = 16;  // blocks within blocks, chosen
constexpr const char* kArc = "arcs of polylines, of which the chords were taken";
constexpr double kMaxFlags = 65536.0;

// Metres per $INSUNITS number; 0: not stated here.
constexpr std::array<double, 8> kDxfUnits = {0.0, 0.0254, 0.3048, 0.0, 0.001, 0.01, 1.0, 1000.0};

// A line with a group code, and the next line with its value.
struct Group {
  int code = -1;
  std::string value;
  std::size_t line = 0;  // line number of the code
};

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos
             ? ""
             : text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

class Groups {
 public:
  explicit Groups(const std::filesystem::path& file) : file_(file.string()), in_(file) { next(); }

  const Group& now() const { return now_; }
  bool is(int code, std::string_view value) const {
    return now_.code == code && now_.value == value;
  }
  bool has_ended() const { return ended_; }
  const std::string& error() const { return error_; }
  void next() {
    std::string code;
    std::string value;
    now_ = {-1, "", line_ + 1};
    if (!std::getline(in_, code)) {
      ended_ = true;
      return;
    }
    ++line_;
    const std::string digits = trimmed(code);
    const auto [end, failed] =
        std::from_chars(digits.data(), digits.data() + digits.size(), now_.code);
    if (failed != std::errc() || end != digits.data() + digits.size()) {
      fail(fmt::format("'{}' is no group code of a DXF", digits.substr(0, 40)));
      return;
    }
    if (!std::getline(in_, value)) {
      fail("the file ends within a group");
      return;
    }
    ++line_;
    now_.value = trimmed(value);
  }
  void fail(const std::string& what) {
    if (error_.empty()) {
      error_ = fmt::format("{}:{}: {}; export it again as DXF (text)", file_, now_.line, what);
    }
    ended_ = true;
  }
  // For flags.
  bool is_odd() {
    const double flags = number();
    return std::abs(flags) < kMaxFlags && (static_cast<int>(flags) & 1) != 0;
  }
  double number() {
    double number = 0.0;
    const std::string& text = now_.value;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failed != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
      fail(fmt::format("'{}' is no number", text.substr(0, 40)));
    }
    return number;
  }

 private:
  std::string file_;
  std::ifstream in_;
  Group now_;
  std::size_t line_ = 0;
  bool ended_ = false;
  std::string error_;
};

struct Insert {
  std::string block;
  std::string layer;
  FloorPoint at{};
  double scale_x = 1.0;
  double scale_y = 1.0;
  double turn = 0.0;  // [rad]
};

struct Block {
  FloorPoint base{};
  std::vector<DrawnLine> lines;
  std::vector<Insert> inserts;
  std::map<std::string, std::size_t> left_out;  // count by kind
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
      } else if (groups_.is(2, "BLOCKS")) {
        read_blocks();
      } else if (groups_.is(2, "ENTITIES")) {
        groups_.next();
        read_entities(model_, "ENDSEC");
      }
    }
    if (!groups_.error().empty()) {
      return bad_input(groups_.error());
    }
    place(model_, {}, "", 0);
    if (points_ > kMaxDrawnPoints) {
      return bad_input(file_ + ": has more points than a plan of rooms; export one storey");
    }
    if (!is_finite_) {
      return bad_input(file_ + ": has a coordinate that is not a finite number; export it again");
    }
    if (const std::vector<std::string> left_out = counts(); !left_out.empty()) {
      drawing_.remarks.push_back(fmt::format("left out: {}", fmt::join(left_out, ", ")));
    }
    return std::move(drawing_);
  }

 private:
  bool is_end() const { return groups_.has_ended() || groups_.now().code == 0; }

  void read_header() {
    while (!groups_.has_ended() && !groups_.is(0, "ENDSEC")) {
      if (groups_.is(9, "$INSUNITS")) {
        groups_.next();
        const double unit = groups_.number();
        if (unit >= 0.0 && unit < static_cast<double>(kDxfUnits.size())) {
          drawing_.metres = kDxfUnits[static_cast<std::size_t>(unit)];
        }
      }
      groups_.next();
    }
  }

  void read_blocks() {
    while (!groups_.has_ended() && !groups_.is(0, "ENDSEC")) {
      if (!groups_.is(0, "BLOCK")) {
        groups_.next();
        continue;
      }
      Block block;
      std::string name;
      for (groups_.next(); !is_end(); groups_.next()) {
        switch (groups_.now().code) {
          case 2:
            name = groups_.now().value;
            break;
          case 10:
            block.base[0] = groups_.number();
            break;
          case 20:
            block.base[1] = groups_.number();
            break;
          default:
            break;
        }
      }
      read_entities(block, "ENDBLK");
      blocks_[name] = std::move(block);
    }
  }

  void read_entities(Block& to, std::string_view end) {
    while (!groups_.has_ended() && !groups_.is(0, end) && !groups_.is(0, "ENDSEC")) {
      if (groups_.now().code != 0) {
        groups_.next();
        continue;
      }
      const std::string kind = groups_.now().value;
      groups_.next();
      if (kind == "LINE") {
        read_line(to);
      } else if (kind == "LWPOLYLINE") {
        read_points(to);
      } else if (kind == "POLYLINE") {
        read_polyline(to);
      } else if (kind == "INSERT") {
        read_insert(to);
      } else if (kind != "ATTRIB" && kind != "SEQEND") {
        ++to.left_out[kind];
      }
    }
  }

  void read_line(Block& to) {
    DrawnLine line;
    line.points.resize(2);
    for (; !is_end(); groups_.next()) {
      switch (groups_.now().code) {
        case 8:
          line.layer = groups_.now().value;
          break;
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
          break;
      }
    }
    keep(to, std::move(line));
  }

  // Consecutive points of an LWPOLYLINE.
  void read_points(Block& to) {
    DrawnLine line;
    for (; !is_end(); groups_.next()) {
      switch (groups_.now().code) {
        case 8:
          line.layer = groups_.now().value;
          break;
        case 42:
          to.left_out[kArc] += groups_.number() != 0.0 ? 1U : 0U;
          break;
        case 70:
          line.is_closed = groups_.is_odd();
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
          break;
      }
    }
    keep(to, std::move(line));
  }

  // Points of a POLYLINE, which are separate entities.
  void read_polyline(Block& to) {
    DrawnLine line;
    for (; !is_end(); groups_.next()) {
      if (groups_.now().code == 8) {
        line.layer = groups_.now().value;
      } else if (groups_.now().code == 70) {
        line.is_closed = groups_.is_odd();
      }
    }
    while (groups_.is(0, "VERTEX")) {
      FloorPoint point{};
      for (groups_.next(); !is_end(); groups_.next()) {
        if (groups_.now().code == 10) {
          point[0] = groups_.number();
        } else if (groups_.now().code == 20) {
          point[1] = groups_.number();
        }
      }
      line.points.push_back(point);
    }
    keep(to, std::move(line));
  }

  void read_insert(Block& to) {
    Insert insert;
    for (; !is_end(); groups_.next()) {
      switch (groups_.now().code) {
        case 2:
          insert.block = groups_.now().value;
          break;
        case 8:
          insert.layer = groups_.now().value;
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
          break;
      }
    }
    to.inserts.push_back(std::move(insert));
  }

  static void keep(Block& to, DrawnLine&& line) {
    if (line.points.size() > 1) {
      to.lines.push_back(std::move(line));
    }
  }

  // Lines of an inserted block; those of its layer "0" are on the layer of the insert.
  void place(const Block& block, const Placing& placing, const std::string& layer, int depth) {
    for (const DrawnLine& line : block.lines) {
      points_ += line.points.size();
      if (points_ > kMaxDrawnPoints) {
        return;
      }
      DrawnLine placed{
          line.layer == "0" && !layer.empty() ? layer : line.layer, {}, line.is_closed};
      placed.points.reserve(line.points.size());
      for (const FloorPoint& p : line.points) {
        placed.points.push_back(placing(p));
        is_finite_ = is_finite_ && std::isfinite(placed.points.back()[0]) &&
                     std::isfinite(placed.points.back()[1]);
      }
      drawing_.lines.push_back(std::move(placed));
    }
    for (const auto& [kind, count] : block.left_out) {
      left_out_[kind] += count;
    }
    for (const Insert& insert : block.inserts) {
      if (++points_ > kMaxDrawnPoints) {
        return;
      }
      const auto found = blocks_.find(insert.block);
      if (found == blocks_.end() || depth == kMaxBlockDepth) {
        ++left_out_["INSERT of a block that is not there"];
        continue;
      }
      const double c = std::cos(insert.turn);
      const double s = std::sin(insert.turn);
      const FloorPoint& base = found->second.base;
      Placing own{c * insert.scale_x, -s * insert.scale_y, s * insert.scale_x, c * insert.scale_y};
      const FloorPoint moved = own(base);
      own.x = insert.at[0] - moved[0];
      own.y = insert.at[1] - moved[1];
      place(found->second,
            placing.after(own),
            insert.layer == "0" && !layer.empty() ? layer : insert.layer,
            depth + 1);
    }
  }

  std::vector<std::string> counts() const {
    std::vector<std::string> all;
    for (const auto& [kind, count] : left_out_) {
      if (count > 0) {
        all.push_back(fmt::format("{} {}", count, kind));
      }
    }
    return all;
  }

  std::string file_;
  Groups groups_;
  Drawing drawing_;
  Block model_;
  std::map<std::string, Block> blocks_;
  std::map<std::string, std::size_t> left_out_;
  std::size_t points_ = 0;
  bool is_finite_ = true;
};

}  // namespace

Expected<Drawing> read_dxf(const std::filesystem::path& file) {
  auto drawing = DxfReader(file).read();
  if (drawing && drawing->lines.empty()) {
    return bad_input(
        file.string() +
        ": has no LINE and no POLYLINE; export the storey's plan as DXF, with its blocks");
  }
  return drawing;
}

}  // namespace rayloc
