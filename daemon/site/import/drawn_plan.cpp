#include "daemon/site/import/drawn_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/listed.h"
#include "daemon/site/import/utf8_text.h"
#include "daemon/site/import/wall_lines.h"

namespace rayloc {
namespace {

constexpr std::size_t kMaxLines = 4000;      // a count, chosen: all pairs are compared
constexpr std::size_t kMaxFurniture = 4000;  // chosen: each one is an object of the scene
constexpr double kCentimetre = 0.01;
constexpr double kMillimetre = 0.001;

struct Rectangle {
  FloorPoint lower{};
  FloorPoint upper{};
};

Rectangle around(const std::vector<WallLine>& lines) {
  Rectangle found{lines.front().from, lines.front().from};
  for (const WallLine& line : lines) {
    for (const FloorPoint& p : {line.from, line.to}) {
      for (const std::size_t axis : {0U, 1U}) {
        found.lower[axis] = std::min(found.lower[axis], p[axis]);
        found.upper[axis] = std::max(found.upper[axis], p[axis]);
      }
    }
  }
  return found;
}

Mesh quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return {{a, b, c, d}, {{0, 1, 2}, {0, 2, 3}}};
}

Mesh upright_wall(const WallLine& line, double low, double high) {
  return quad({line.from[0], line.from[1], low},
              {line.to[0], line.to[1], low},
              {line.to[0], line.to[1], high},
              {line.from[0], line.from[1], high});
}

Mesh level(const Rectangle& r, double z) {
  return quad({r.lower[0], r.lower[1], z},
              {r.upper[0], r.lower[1], z},
              {r.upper[0], r.upper[1], z},
              {r.lower[0], r.upper[1], z});
}

std::vector<WallLine> pieces_of(const DrawnLine& line) {
  std::vector<WallLine> pieces;
  const std::size_t n = line.points.size();
  for (std::size_t i = 0; i + (line.is_closed ? 0 : 1) < n; ++i) {
    pieces.push_back({line.points[i], line.points[(i + 1) % n], line.layer, 0.0});
  }
  return pieces;
}

// Removes points equal to the previous one: a line that is drawn back to its beginning ends beside
// it, by rounding, and would cross its first side there.
std::vector<FloorPoint> without_repeated(const std::vector<FloorPoint>& points) {
  const auto is_same = [](const FloorPoint& a, const FloorPoint& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1]) < kMillimetre;
  };
  std::vector<FloorPoint> kept;
  kept.reserve(points.size());
  std::unique_copy(points.begin(), points.end(), std::back_inserter(kept), is_same);
  while (kept.size() > 1 && is_same(kept.back(), kept.front())) {
    kept.pop_back();
  }
  return kept;
}

// An edge of a closed line that crosses another edge of it.
std::optional<WallLine> own_crossing(const std::vector<FloorPoint>& drawn) {
  const std::vector<FloorPoint> points = without_repeated(drawn);
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (segments_cross(points[i], points[i + 1], points[j], points[(j + 1) % n])) {
        return WallLine{points[j], points[(j + 1) % n], "", 0.0};
      }
    }
  }
  return std::nullopt;
}

// Without case, as programs compare the names of layers.
bool holds_layer(const std::set<std::string>& layers, const std::string& name) {
  return std::any_of(layers.begin(), layers.end(), [&](const std::string& one) {
    return lower_case(one) == lower_case(name);
  });
}

// The reason why a layer has no line, and the remedy; empty for a layer that is not in the file.
std::optional<std::string> fault_of(const std::string& layer, const Drawing& drawing) {
  if (holds_layer(drawing.hidden_layers, layer)) {
    return fmt::format("layer '{}' is off or frozen; show it in the drawing, and export it again",
                       layer);
  }
  if (holds_layer(drawing.empty_layers, layer)) {
    return fmt::format("layer '{}' is empty; draw the walls there, or name another layer", layer);
  }
  return std::nullopt;
}

// The rectangle around a closed line, aligned with its first side.
Mesh top_of(const DrawnLine& line) {
  const FloorPoint& origin = line.points[0];
  const double x = line.points[1][0] - origin[0];
  const double y = line.points[1][1] - origin[1];
  const double length = std::max(std::hypot(x, y), kMillimetre);
  FloorPoint lower{};
  FloorPoint upper{};
  for (const FloorPoint& p : line.points) {
    const double u = (x * (p[0] - origin[0]) + y * (p[1] - origin[1])) / length;
    const double v = (x * (p[1] - origin[1]) - y * (p[0] - origin[0])) / length;
    lower = {std::min(lower[0], u), std::min(lower[1], v)};
    upper = {std::max(upper[0], u), std::max(upper[1], v)};
  }
  const auto at = [&](double u, double v) {
    return Vec3d{origin[0] + (x * u - y * v) / length, origin[1] + (y * u + x * v) / length, kTop};
  };
  return quad(at(lower[0], lower[1]),
              at(upper[0], lower[1]),
              at(upper[0], upper[1]),
              at(lower[0], upper[1]));
}

class PlanMaker {
 public:
  PlanMaker(const MaterialTable& table, double height) : table_(table), height_(height) {}

  // Returns an Error for an outline that crosses itself: its inside is ambiguous.
  Expected<void> add(const DrawnLine& line) {
    const std::string kind = table_.layer(line.layer);
    const std::size_t before = kind == "wall" ? walls_.size() : windows_.size();
    if ((kind == "wall" || kind == "window") && before + line.points.size() > kMaxLines) {
      return bad_input(
          fmt::format("has more than {} lines of walls or windows; export one storey, "
                      "without hatches",
                      kMaxLines));
    }
    if (kind == "wall" && line.is_closed) {
      if (const auto crossing = own_crossing(line.points)) {
        return bad_input(fmt::format(
            "an outline of layer '{}' crosses itself, between {:.2f}, {:.2f} m and "
            "{:.2f}, {:.2f} m of the drawing, y up; draw its corners one behind the other",
            line.layer,
            crossing->from[0],
            crossing->from[1],
            crossing->to[0],
            crossing->to[1]));
      }
    }
    if (kind == "wall" || kind == "window") {
      std::vector<WallLine>& to = kind == "wall" ? walls_ : windows_;
      const std::vector<WallLine> pieces = pieces_of(line);
      to.insert(to.end(), pieces.begin(), pieces.end());
    } else if (kind == "furniture" && line.is_closed && line.points.size() > 2) {
      if (++furniture_ > kMaxFurniture) {
        return bad_input(
            fmt::format("has more than {} closed lines of furniture; export one storey, without "
                        "hatches",
                        kMaxFurniture));
      }
      model_.parts.push_back({line.layer, "", top_of(line)});
    } else if (kind == "door") {
      has_doors_ = true;
    } else if (kind.empty()) {
      unknown_.insert(line.layer);
    }
    return {};
  }

  Expected<Model> finish(const std::set<std::string>& layers, const Drawing& drawing) {
    if (walls_.empty()) {
      return no_walls(layers, drawing);
    }
    const Rectangle whole = around(walls_);
    std::vector<WallLine> walls = wall_lines(walls_);
    const std::vector<WallLine> windows = panes();
    for (const WallLine& window : windows) {
      walls = cut_at(walls, window);
    }
    for (const WallLine& wall : walls) {
      add_wall(wall, 0.0, height_);
    }
    for (const WallLine& window : windows) {
      model_.parts.push_back({window.layer, "window", upright_wall(window, kSill, kHead)});
      add_wall({window.from, window.to, walls_.front().layer, 0.0}, 0.0, kSill);
      add_wall({window.from, window.to, walls_.front().layer, 0.0}, kHead, height_);
    }
    model_.parts.push_back({"floor", "", level(whole, 0.0)});
    model_.parts.push_back({"ceiling", "", level(whole, height_)});
    move(whole.lower);
    add_remarks(walls.size(), windows.size());
    return std::move(model_);
  }

  Model& model() { return model_; }

 private:
  // The layers that could have held walls, and the remedy.
  tl::unexpected<Error> no_walls(const std::set<std::string>& layers,
                                 const Drawing& drawing) const {
    for (const auto* const unread : {&drawing.hidden_layers, &drawing.empty_layers}) {
      for (const std::string& layer : *unread) {
        if (table_.layer(layer) == "wall") {
          return bad_input("no other layer holds walls: " + *fault_of(layer, drawing));
        }
      }
    }
    return bad_input(fmt::format(
        "no layer is known to hold walls; its layers are {}. Name those of walls (--walls \"{}\"), "
        "or all kinds in a table: rayloc scene import --print-materials > materials.toml, "
        "[layers]{}{}",
        listed(layers),
        *layers.begin(),
        drawing.remarks.empty() ? "" : "; ",
        fmt::join(drawing.remarks, "; ")));
  }

  // One line per window: the longest of the adjacent lines of panes and frames.
  std::vector<WallLine> panes() const {
    std::vector<WallLine> all = wall_lines(windows_);
    std::stable_sort(all.begin(), all.end(), [](const WallLine& a, const WallLine& b) {
      return length_of(a) > length_of(b);
    });
    std::vector<WallLine> kept;
    for (const WallLine& one : all) {
      std::vector<WallLine> rest = {one};
      for (const WallLine& known : kept) {
        rest = cut_at(rest, known);
      }
      if (rest.size() == 1 && length_of(rest.front()) == length_of(one)) {
        kept.push_back(one);
      }
    }
    return kept;
  }

  void add_wall(const WallLine& wall, double low, double high) {
    ModelPart part{wall.layer, "", upright_wall(wall, low, high)};
    part.thickness = std::round(wall.thickness / kCentimetre) * kCentimetre;
    model_.parts.push_back(std::move(part));
    paired_ += wall.thickness > 0.0 ? 1 : 0;
  }

  void move(const FloorPoint& origin) {
    for (ModelPart& part : model_.parts) {
      for (Vec3d& v : part.mesh.vertices) {
        v = {v.x - origin[0], v.y - origin[1], v.z};
      }
    }
    if (std::hypot(origin[0], origin[1]) > kMillimetre) {
      model_.remarks.push_back(fmt::format(
          "the origin is the lower left corner of the walls, {:.3f}, {:.3f} m of the drawing",
          origin[0],
          origin[1]));
    }
  }

  void add_remarks(std::size_t walls, std::size_t windows) {
    model_.remarks.push_back(
        fmt::format("{} pieces of wall, {} of them with both faces drawn; floor to ceiling {:g} m "
                    "(--height states another)",
                    walls,
                    paired_,
                    height_));
    if (windows > 0) {
      model_.remarks.push_back(
          fmt::format("{} windows, taken to be from {:g} to {:g} m", windows, kSill, kHead));
    }
    if (has_doors_) {
      model_.remarks.emplace_back("doors are left open: their leaves are not in the scene");
    }
    if (!unknown_.empty()) {
      model_.remarks.push_back(fmt::format(
          "left out, as [layers] of the table does not have them: {}", listed(unknown_)));
    }
  }

  const MaterialTable& table_;
  const double height_;
  Model model_;
  std::vector<WallLine> walls_;
  std::vector<WallLine> windows_;
  std::set<std::string> unknown_;
  std::size_t furniture_ = 0;
  std::size_t paired_ = 0;
  bool has_doors_ = false;
};

double unit_of(const Drawing& drawing, double given, std::vector<std::string>& remarks) {
  if (given > 0.0) {
    remarks.push_back(fmt::format("a unit is {} m, by --unit", given));
    return given;
  }
  if (drawing.metres > 0.0) {
    remarks.push_back(fmt::format("a unit is {} m, as the drawing states", drawing.metres));
    return drawing.metres;
  }
  double lower = 0.0;
  double upper = 0.0;
  for (const DrawnLine& line : drawing.lines) {
    for (const FloorPoint& p : line.points) {
      lower = std::min({lower, p[0], p[1]});
      upper = std::max({upper, p[0], p[1]});
    }
  }
  const bool is_metres = upper - lower <= kLargestStorey;
  remarks.emplace_back(std::string(is_metres ? "metres" : "millimetres") +
                       ", by the size of the drawing (--unit states another)");
  return is_metres ? 1.0 : kMillimetre;
}

}  // namespace

Expected<Model> drawn_plan(const Drawing& drawing,
                           const MaterialTable& table,
                           const DrawnPlanOptions& options) {
  PlanMaker maker(table, options.height > 0.0 ? options.height : kUsualHeight);
  maker.model().remarks = drawing.remarks;
  const double metres = unit_of(drawing, options.metres, maker.model().remarks);
  std::set<std::string> layers;
  for (DrawnLine line : drawing.lines) {
    layers.insert(line.layer);
    for (FloorPoint& p : line.points) {
      p = {metres * p[0], metres * p[1]};
    }
    RAYLOC_TRY(maker.add(line));
  }
  for (const std::string& named : table.named_walls()) {
    if (holds_layer(layers, named)) {
      continue;
    }
    return bad_input(
        "--walls: " +
        fault_of(named, drawing)
            .value_or(fmt::format(
                "no line is on a layer '{}'; its layers are {}", named, listed(layers))));
  }
  return maker.finish(layers, drawing);
}

}  // namespace rayloc
