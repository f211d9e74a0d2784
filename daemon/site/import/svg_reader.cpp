#include "daemon/site/import/svg_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/svg_text.h"
#include "daemon/site/model/site_copy.h"
#include "engine/scene/read/xml_file.h"

namespace rayloc {
namespace {

constexpr int kMaxGroupDepth = 64;      // groups within groups, chosen
constexpr int kCorners = 16;            // for a circle, chosen
constexpr double kMinRoom = 1.5;        // [m], chosen: the longer side of a plan of rooms
constexpr double kPixel = 0.0254 / 96;  // [m] on paper; CSS 2.1, 4.3.2

constexpr std::array<std::string_view, 4> kGroups = {"g", "svg", "a", "switch"};
constexpr std::array<std::string_view, 7> kShapes = {
    "path", "line", "polyline", "polygon", "rect", "circle", "ellipse"};
// Elements that a person would miss; definitions and descriptions are no part of the drawing.
constexpr std::array<std::string_view, 4> kMissed = {"text", "image", "flowRoot", "foreignObject"};

bool is_one_of(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_hidden(const pugi::xml_node& node) {
  std::string style = node.attribute("style").value();
  std::erase(style, ' ');
  return std::string_view(node.attribute("display").value()) == "none" ||
         std::string_view(node.attribute("visibility").value()) == "hidden" ||
         style.find("display:none") != std::string::npos ||
         style.find("visibility:hidden") != std::string::npos;
}

bool is_inkscape_layer(const pugi::xml_node& node) {
  return std::string_view(node.attribute("inkscape:groupmode").value()) == "layer";
}

// The first of these attributes that is present.
std::string first_of(const pugi::xml_node& node, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (const pugi::xml_attribute found = node.attribute(name); found && *found.value() != '\0') {
      return found.value();
    }
  }
  return "";
}

std::string joined(const std::string& layer, const std::string& name) {
  return layer.empty() || name.empty() ? layer + name : layer + "/" + name;
}

class SvgReader {
 public:
  SvgReader(std::string_view text, const std::filesystem::path& file, const ModelUnits& units)
      : xml_(text, file.string()), units_(units) {}

  Expected<Drawing> read() {
    const auto root = xml_.parse("svg");
    RAYLOC_TRY(root);
    collect(*root);
    // On paper y points down.
    walk(*root, {1.0, 0.0, 0.0, -1.0}, "", 0);
    RAYLOC_TRY(xml_.check());
    if (points_ > kMaxDrawnPoints) {
      return refuse("has more points than a plan of rooms; export one storey");
    }
    if (drawing_.lines.empty()) {
      return refuse(
          "has no path, line, polyline, rectangle or circle that can be seen; draw the walls over "
          "a picture, in a layer of their own");
    }
    for (const std::string& layer : layers_) {
      if (!used_.contains(layer)) {
        drawing_.empty_layers.insert(layer);
      }
    }
    add_remarks();
    return scaled(*root);
  }

 private:
  tl::unexpected<Error> refuse(const std::string& what) const {
    return bad_input(xml_.name() + ": " + what);
  }

  // Collects all elements that <use> may name, and detects layers written by Inkscape.
  void collect(const pugi::xml_node& root) {
    struct ShapeCollector final : pugi::xml_tree_walker {
      explicit ShapeCollector(SvgReader& reader) : reader_(reader) {}
      bool for_each(pugi::xml_node& node) override {
        if (const pugi::xml_attribute id = node.attribute("id")) {
          reader_.by_id_.try_emplace(id.value(), node);
        }
        reader_.has_layers_ = reader_.has_layers_ || is_inkscape_layer(node);
        return true;
      }
      SvgReader& reader_;
    };
    ShapeCollector collector(*this);
    pugi::xml_node(root).traverse(collector);
  }

  std::string layer_within(const pugi::xml_node& group, const std::string& above) const {
    if (has_layers_) {
      return is_inkscape_layer(group) ? joined(above, first_of(group, {"inkscape:label", "id"}))
                                      : above;
    }
    return joined(above, first_of(group, {"inkscape:label", "id", "class"}));
  }

  std::string layer_of(const pugi::xml_node& shape, const std::string& above) const {
    const std::string own = has_layers_ ? "" : shape.attribute("class").value();
    const std::string layer = joined(above, own);
    return !layer.empty() ? layer : first_of(shape, {"inkscape:label", "id"});
  }

  void walk(const pugi::xml_node& parent,
            const Placing& placing,
            const std::string& layer,
            int depth) {
    for (const pugi::xml_node& node : parent.children()) {
      if (node.type() == pugi::node_element && points_ <= kMaxDrawnPoints) {
        draw(node, placing, layer, depth);
      }
    }
  }

  void draw(const pugi::xml_node& node, Placing placing, const std::string& layer, int depth) {
    const std::string_view name = node.name();
    const bool is_group = is_one_of(kGroups, name);
    const bool is_use = name == "use";
    if (!is_group && !is_use && !is_one_of(kShapes, name)) {
      left_out_[is_one_of(kMissed, name) ? node.name() : ""] += 1;
      return;
    }
    if (is_hidden(node)) {
      ++left_out_["hidden"];
      return;
    }
    if (depth == kMaxGroupDepth || ++points_ > kMaxDrawnPoints) {
      ++left_out_["in groups that are too deep"];
      return;
    }
    if (const pugi::xml_attribute given = node.attribute("transform")) {
      const auto own = svg_transform(given.value());
      if (!own) {
        xml_.complain(node, fmt::format("'{:.60}' is no transform", given.value()));
        return;
      }
      placing = placing.after(*own);
    }
    if (is_use) {
      place(node, placing, layer, depth);
    } else if (is_group) {
      if (name == "svg") {
        placing = placing.after(corner_of(node)).after(viewport(node, node));
      }
      const std::string own = layer_within(node, layer);
      if (own != layer) {
        layers_.insert(own);
      }
      walk(node, placing, own, depth + 1);
    } else {
      add(node, placing, layer_of(node, layer));
    }
  }

  void place(const pugi::xml_node& use,
             const Placing& placing,
             const std::string& layer,
             int depth) {
    const std::string target = first_of(use, {"href", "xlink:href"});
    const auto found = target.starts_with('#') ? by_id_.find(target.substr(1)) : by_id_.end();
    if (found == by_id_.end()) {
      ++left_out_["<use> of what is not in the file"];
      return;
    }
    const Placing moved = placing.after(corner_of(use));
    if (std::string_view(found->second.name()) == "symbol") {
      walk(found->second, moved.after(viewport(found->second, use)), layer, depth + 1);
    } else {
      draw(found->second, moved, layer, depth + 1);
    }
  }

  Placing corner_of(const pugi::xml_node& node) {
    return {1.0, 0.0, 0.0, 1.0, length(node, "x", 0.0), length(node, "y", 0.0)};
  }

  // Transform from the viewBox of a symbol or of a nested drawing to the width and height that
  // `sized` states (SVG 1.1, 7.7 and 7.8). Without these, or with percentages of the parent, the
  // units inside and outside are equal.
  Placing viewport(const pugi::xml_node& node, const pugi::xml_node& sized) {
    const auto box = svg_numbers(node.attribute("viewBox").value());
    if (!box || box->size() != 4 || (*box)[2] <= 0.0 || (*box)[3] <= 0.0) {
      return {};
    }
    const auto side = [&](const char* key, double otherwise) {
      const auto given = svg_length(sized.attribute(key).value());
      return given && given->unit == "%" ? otherwise : length(sized, key, otherwise);
    };
    const double width = side("width", (*box)[2]);
    const double height = side("height", (*box)[3]);
    double sx = width / (*box)[2];
    double sy = height / (*box)[3];
    const std::string_view fit = node.attribute("preserveAspectRatio").as_string("xMidYMid");
    if (!fit.starts_with("none")) {
      const bool is_cut = fit.find("slice") != std::string_view::npos;
      sx = sy = is_cut ? std::max(sx, sy) : std::min(sx, sy);
    }
    const auto share = [&](std::string_view least, std::string_view most) {
      return fit.find(least) != std::string_view::npos  ? 0.0
             : fit.find(most) != std::string_view::npos ? 1.0
                                                        : 0.5;
    };
    return {sx,
            0.0,
            0.0,
            sy,
            share("xMin", "xMax") * (width - sx * (*box)[2]) - sx * (*box)[0],
            share("YMin", "YMax") * (height - sy * (*box)[3]) - sy * (*box)[1]};
  }

  // An attribute in units of the drawing; NaN and a remark if it is no such length.
  double length(const pugi::xml_node& node, const char* name, double otherwise) {
    const pugi::xml_attribute given = node.attribute(name);
    if (!given) {
      return otherwise;
    }
    const auto read = svg_length(given.value());
    if (read && (read->unit.empty() || read->unit == "px")) {
      return read->number;
    }
    if (read && read->metres() != 0.0) {
      return read->metres() / kPixel;
    }
    xml_.complain(node,
                  fmt::format("{}=\"{:.60}\" is no length; write a number", name, given.value()));
    return std::numeric_limits<double>::quiet_NaN();
  }

  void add(const pugi::xml_node& shape, const Placing& placing, const std::string& layer) {
    const std::string layer_name = layer.empty() ? "no layer" : layer;
    for (DrawnLine& line : lines_of(shape)) {
      points_ += line.points.size();
      bool is_finite = true;
      for (FloorPoint& p : line.points) {
        p = placing(p);
        is_finite = is_finite && std::isfinite(p[0]) && std::isfinite(p[1]);
      }
      if (!is_finite) {
        xml_.complain(shape, "has a coordinate that is not a finite number");
        return;
      }
      line.layer = layer_name;
      used_.insert(layer_name);
      drawing_.lines.push_back(std::move(line));
    }
  }

  std::vector<DrawnLine> lines_of(const pugi::xml_node& shape) {
    const std::string_view name = shape.name();
    const auto at = [&](const char* key) { return length(shape, key, 0.0); };
    if (name == "line") {
      return {{"", {{at("x1"), at("y1")}, {at("x2"), at("y2")}}, false}};
    }
    if (name == "rect") {
      const double x = at("x");
      const double y = at("y");
      const double w = at("width");
      const double h = at("height");
      return {{"", {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}, true}};
    }
    if (name == "circle" || name == "ellipse") {
      return {around(shape, name == "circle")};
    }
    if (name == "path") {
      auto lines = svg_path(shape.attribute("d").value());
      if (!lines) {
        xml_.complain(shape, "its d=\"\" is no path: a letter or a number is wrong there");
      }
      return lines ? *std::move(lines) : std::vector<DrawnLine>{};
    }
    const auto numbers = svg_numbers(shape.attribute("points").value());
    if (!numbers || numbers->size() % 2 != 0) {
      xml_.complain(shape, "its points=\"\" is no list of pairs of numbers");
      return {};
    }
    DrawnLine line{"", {}, name == "polygon"};
    for (std::size_t i = 0; i + 1 < numbers->size(); i += 2) {
      line.points.push_back({(*numbers)[i], (*numbers)[i + 1]});
    }
    return line.points.size() > 1 ? std::vector{std::move(line)} : std::vector<DrawnLine>{};
  }

  DrawnLine around(const pugi::xml_node& shape, bool is_circle) {
    const double rx = length(shape, is_circle ? "r" : "rx", 0.0);
    const double ry = length(shape, is_circle ? "r" : "ry", 0.0);
    DrawnLine line{"", {}, true};
    for (int i = 0; i < kCorners; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / kCorners;
      line.points.push_back({length(shape, "cx", 0.0) + rx * std::cos(turn),
                             length(shape, "cy", 0.0) + ry * std::sin(turn)});
    }
    return line;
  }

  void add_remarks() {
    std::vector<std::string> all;
    for (const auto& [what, count] : left_out_) {
      if (!what.empty() && count > 0) {
        all.push_back(fmt::format("{} {}", count, what));
      }
    }
    if (!all.empty()) {
      drawing_.remarks.push_back(fmt::format("left out: {}", fmt::join(all, ", ")));
    }
  }

  // [m] of paper per unit; 0: the file states no paper size.
  double paper_unit(const pugi::xml_node& root) {
    const auto box = svg_numbers(root.attribute("viewBox").value());
    for (const auto& [name, side] : {std::pair{"width", 2U}, {"height", 3U}}) {
      const auto given = svg_length(root.attribute(name).value());
      if (!given || given->metres() <= 0.0) {
        continue;
      }
      const bool has_box = box && box->size() == 4 && (*box)[side] > 0.0;
      return has_box ? given->metres() / (*box)[side] : kPixel;
    }
    return 0.0;
  }

  double longer_side() const {
    FloorPoint lower = drawing_.lines.front().points.front();
    FloorPoint upper = lower;
    for (const DrawnLine& line : drawing_.lines) {
      for (const FloorPoint& p : line.points) {
        lower = {std::min(lower[0], p[0]), std::min(lower[1], p[1])};
        upper = {std::max(upper[0], p[0]), std::max(upper[1], p[1])};
      }
    }
    return std::max(upper[0] - lower[0], upper[1] - lower[1]);
  }

  Expected<Drawing> scaled(const pugi::xml_node& root) {
    if (units_.metres > 0.0) {
      return std::move(drawing_);  // as stated by the user
    }
    const double paper = paper_unit(root);
    if (units_.scale > 0.0) {
      drawing_.remarks.push_back(fmt::format("drawn at 1:{:g}, by --scale", units_.scale));
      drawing_.metres = units_.scale * (paper > 0.0 ? paper : kPixel);
      return std::move(drawing_);
    }
    constexpr const char* kCure =
        "state its scale (--scale 50, for 1:50), or what a unit of it is (--unit cm)";
    if (paper <= 0.0) {
      return refuse(fmt::format("does not state its size: its lengths are pixels; {}", kCure));
    }
    if (const double side = longer_side() * paper; side < kMinRoom) {
      return refuse(fmt::format(
          "is {:.0f} mm large on paper, and does not state its scale; {}", 1e3 * side, kCure));
    }
    drawing_.metres = paper;
    return std::move(drawing_);
  }

  XmlFile xml_;
  const ModelUnits& units_;
  Drawing drawing_;
  std::map<std::string, pugi::xml_node> by_id_;
  std::map<std::string, int> left_out_;  // count by kind
  std::set<std::string> layers_;
  std::set<std::string> used_;
  std::size_t points_ = 0;  // and placed elements
  bool has_layers_ = false;
};

}  // namespace

Expected<Drawing> read_svg(const std::filesystem::path& file, const ModelUnits& units) {
  const auto text = read_file(file);
  RAYLOC_TRY(text);
  return SvgReader(*text, file, units).read();
}

}  // namespace rayloc
