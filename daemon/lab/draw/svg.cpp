#include "daemon/lab/draw/svg.h"

#include <array>
#include <cstddef>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/draw/html.h"

namespace rayloc::draw {
namespace {

std::string colour_text(const Colour& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

std::string opacity_text(std::string_view attribute, const Colour& colour) {
  return colour.opacity < 1.0 ? fmt::format(" {}=\"{:.3g}\"", attribute, colour.opacity) : "";
}

std::string fill_text(const Colour& colour) {
  return fmt::format(" fill=\"{}\"", colour_text(colour)) + opacity_text("fill-opacity", colour);
}

std::string pen_text(const Pen& pen) {
  return fmt::format(R"( stroke="{}" stroke-width="{:.2f}")", colour_text(pen.colour), pen.width) +
         opacity_text("stroke-opacity", pen.colour) +
         (pen.dashed ? " stroke-dasharray=\"4 3\"" : "");
}

std::string points_text(const std::vector<PagePoint>& points) {
  std::string text;
  for (const PagePoint& p : points) {
    text += fmt::format("{}{:.2f},{:.2f}", text.empty() ? "" : " ", p.x, p.y);
  }
  return text;
}

struct Element {
  std::string operator()(const Polygon& polygon) const {
    // Neighbouring polygons overlap a little, to hide the page between them.
    const Pen seam{polygon.fill, 0.3};
    return fmt::format("<polygon points=\"{}\"{}{}/>\n",
                       points_text(polygon.corners),
                       fill_text(polygon.fill),
                       polygon.fill.opacity < 1.0 ? "" : pen_text(seam));
  }
  std::string operator()(const Line& line) const {
    return fmt::format("<polyline points=\"{}\" fill=\"none\"{}/>\n",
                       points_text(line.points),
                       pen_text(line.pen));
  }
  std::string operator()(const Circle& circle) const {
    return fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\"{}{}/>\n",
                       circle.centre.x,
                       circle.centre.y,
                       circle.radius,
                       fill_text(circle.fill),
                       circle.outline ? pen_text(*circle.outline) : "");
  }
  std::string operator()(const Text& text) const {
    constexpr std::array<std::string_view, 3> kAnchors = {"start", "middle", "end"};
    std::string element = fmt::format(R"(<text x="{:.2f}" y="{:.2f}" font-size="{:.2f}"{})",
                                      text.at.x,
                                      text.at.y,
                                      text.size,
                                      fill_text(text.colour));
    if (text.anchor != TextAnchor::kStart) {
      element +=
          fmt::format(" text-anchor=\"{}\"", kAnchors.at(static_cast<std::size_t>(text.anchor)));
    }
    if (text.bold) {
      element += " font-weight=\"bold\"";
    }
    if (text.degrees != 0.0) {
      element += fmt::format(
          " transform=\"rotate({:.2f} {:.2f} {:.2f})\"", -text.degrees, text.at.x, text.at.y);
    }
    if (text.halo) {
      element += R"( stroke="#ffffff" stroke-width="2.5" paint-order="stroke")";
    }
    return element + ">" + html_text(text.text) + "</text>\n";
  }
};

}  // namespace

std::string to_svg(const Drawing& drawing) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + to_svg_element(drawing);
}

std::string to_svg_element(const Drawing& drawing) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" "
      "stroke-linejoin=\"round\" stroke-linecap=\"round\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      drawing.width,
      drawing.height);
  for (const Shape& shape : drawing.shapes) {
    svg += std::visit(Element{}, shape);
  }
  return svg + "</svg>\n";
}

}  // namespace rayloc::draw
