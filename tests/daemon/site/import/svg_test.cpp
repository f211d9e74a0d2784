// Drawings in SVG, by another program and by hand, and what is none.
#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/drawn_plan.h"
#include "daemon/site/import/svg_text.h"
#include "tests/daemon/site/import/import_files.h"

namespace rayloc::svg_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// By svgwrite, a program of other people: an office of 6 x 4 m inside, at 1:50 on paper, in layers
// as Inkscape has them; the south wall with a window, a desk that a group turns and moves.
constexpr const char* kWriter = R"(
import sys, svgwrite
from svgwrite.extensions import Inkscape
d = svgwrite.Drawing(sys.argv[1], size=('160mm', '120mm'), viewBox='0 0 160 120', profile='full')
ink = Inkscape(d)
plan = ink.layer(label='Plan'); d.add(plan)
walls = ink.layer(label='Walls'); plan.add(walls)
walls.add(d.rect((16, 16), (128, 88)))
walls.add(d.polygon([(20, 20), (140, 20), (140, 100), (20, 100)]))
glass = ink.layer(label='Windows'); plan.add(glass)
glass.add(d.line((60, 101), (90, 101)))
furniture = ink.layer(label='Furniture'); plan.add(furniture)
group = d.g(transform='translate(100, 40) rotate(90)'); furniture.add(group)
group.add(d.path(d='m 0,0 h 32 v -16 h -32 z'))
hidden = ink.layer(label='Walls of last year', style='display:none'); d.add(hidden)
hidden.add(d.line((0, 0), (500, 500)))
notes = ink.layer(label='Notes'); d.add(notes)
notes.add(d.text('Office', (50, 50)))
d.save()
)";

class Svg : public test::ImportFiles {
 protected:
  static std::string drawing(const std::string& content,
                             const std::string& size =
                                 "width=\"6000mm\" height=\"4000mm\" "
                                 "viewBox=\"0 0 600 400\"") {
    return "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" " + size + ">\n" +
           content + "\n</svg>\n";
  }
  std::string refusal(const std::string& content) const {
    return ImportFiles::refusal("plan.svg", content);
  }
  Expected<ImportedScene> imported(const std::string& content,
                                   const ImportOptions& options = {}) const {
    return import(file("plan.svg", content), options);
  }
};

TEST_F(Svg, ADrawingOfAnotherProgramBecomesARoom) {
  if (std::system("/usr/bin/python3 -c 'import svgwrite' 2> /dev/null") != 0) {
    GTEST_SKIP() << "svgwrite (Debian: python3-svgwrite) is not installed";
  }
  const path made = folder_ / "office.svg";
  ASSERT_EQ(
      std::system(("/usr/bin/python3 " + file("writer.py", kWriter).string() + " " + made.string())
                      .c_str()),
      0);
  ImportOptions options;
  options.units.scale = 50.0;
  const auto room = import(made, options);
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_NEAR(room->bounds.size().x, 6.4, 1e-9);
  EXPECT_NEAR(room->bounds.size().y, 4.4, 1e-9);
  const auto object = [&](const std::string& name) {
    const auto found = std::find_if(room->scene.objects.begin(),
                                    room->scene.objects.end(),
                                    [&](const StatedObject& one) { return one.name == name; });
    EXPECT_NE(found, room->scene.objects.end()) << name;
    return found == room->scene.objects.end() ? StatedObject{} : *found;
  };
  // Walls of 4 mm on paper are 20 cm; y points up in a room, and down on paper.
  const StatedObject window = object("Plan_Windows");
  EXPECT_EQ(window.material, "glass");
  EXPECT_NEAR(window.mesh.vertices.at(0).y, 0.15, 1e-9);
  const StatedObject wall = object("Plan_Walls");
  const auto material = std::find_if(room->scene.materials.begin(),
                                     room->scene.materials.end(),
                                     [&](const auto& one) { return one.name == wall.material; });
  EXPECT_NEAR(material->thickness, 0.2, 1e-9);
  const StatedObject desk = object("Plan_Furniture");
  for (const Vec3d& v : desk.mesh.vertices) {  // 1.6 m along y, 0.8 along x, beside 4.2, 3.2 m
    EXPECT_GT(v.x, 4.199);
    EXPECT_LT(v.x, 5.001);
    EXPECT_GT(v.y, 1.599);
    EXPECT_LT(v.y, 3.201);
  }
  EXPECT_THAT(remarks(*room), HasSubstr("left out: 1 hidden, 1 text"));
  EXPECT_THAT(remarks(*room), HasSubstr("drawn at 1:50, by --scale"));
  // Without a scale the size is ambiguous.
  const auto unscaled = import(made);
  ASSERT_FALSE(unscaled);
  EXPECT_THAT(unscaled.error().message, HasSubstr("is 128 mm large on paper"));
  EXPECT_THAT(unscaled.error().message, HasSubstr("--scale 50, for 1:50"));
}

TEST_F(Svg, GroupsOfAHandWrittenFileAreLayers) {
  // A unit is a centimetre, according to width and viewBox.
  const auto room = imported(drawing(R"(
<defs><g id="seat"><rect width="50" height="50"/></g></defs>
<g id="walls"><path d="M0 0H600V400H0z"/><line x1="300" y1="0" x2="300" y2="2500mm" visibility="hidden"/></g>
<line class="wall" x1="300" y1="0" x2="300" y2="250"/>
<g class="furniture"><use href="#seat" x="100" y="300"/></g>)"));
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_NEAR(room->bounds.size().x, 6.0, 1e-9);
  EXPECT_NEAR(room->bounds.size().y, 4.0, 1e-9);
  std::vector<std::string> names;
  names.reserve(room->scene.objects.size());
  for (const StatedObject& object : room->scene.objects) {
    names.push_back(object.name);
  }
  EXPECT_THAT(
      names,
      ElementsAre(
          "furniture_seat", "walls", "walls_2", "walls_3", "walls_4", "wall", "floor", "ceiling"));
  const auto& seat = room->scene.objects[0].mesh.vertices;
  for (const Vec3d& v : seat) {
    EXPECT_NEAR(v.x, 1.25, 0.25 + 1e-9);
    EXPECT_NEAR(v.y, 0.75, 0.25 + 1e-9);
    EXPECT_NEAR(v.z, kTop, 1e-9);
  }
}

// Drawn back to the beginning in steps, a line ends beside it by rounding.
TEST_F(Svg, AnOutlineThatIsDrawnBackDoesNotCrossItself) {
  for (int i = 21; i <= 40; ++i) {
    const std::string x = fmt::format("{:.1f}", 0.1 * i);
    const std::string d = fmt::format("m 0.1,0.1 h {0} v 3.1 h -{0} v -3.1 z", x);
    const auto room = imported(drawing(fmt::format(R"(<path id="wall" d="{}"/>)", d),
                                       R"(width="8000mm" height="6000mm" viewBox="0 0 8 6")"));
    ASSERT_TRUE(room) << x << ": " << room.error().message;
    EXPECT_NEAR(room->bounds.size().x, 0.1 * i, 1e-9);
  }
}

TEST_F(Svg, PixelsNeedAStatedScale) {
  const std::string pixels =
      drawing(R"(<rect id="wall" width="400" height="300"/>)", R"(width="800" height="600")");
  EXPECT_THAT(refusal(pixels), HasSubstr("its lengths are pixels; state its scale"));
  const auto result = imported(pixels, {{0.01}, 0.0});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_NEAR(result->bounds.size().x, 4.0, 1e-9);
  ImportOptions options;
  options.units.scale = 50.0;
  const auto scaled = imported(pixels, options);
  ASSERT_TRUE(scaled) << scaled.error().message;
  EXPECT_NEAR(scaled->bounds.size().x, 400 * 50 * 0.0254 / 96, 1e-9);
  const auto of_another = import(file("room.obj", "o floor\nv 0 0 0\nf 1 1 1\n"), options);
  ASSERT_FALSE(of_another);
  EXPECT_THAT(of_another.error().message, HasSubstr("--scale is of SVG"));
}

TEST_F(Svg, RefusesInvalidPlansWithARemedy) {
  EXPECT_THAT(refusal("<?xml version=\"1.0\"?>\n<html/>"), HasSubstr("is XML, but no SVG"));
  EXPECT_THAT(refusal("<svg><g></svg>"), HasSubstr("plan.svg:1:11: this is not well-formed XML"));
  EXPECT_THAT(refusal(drawing("<text>Office</text><image/>")),
              HasSubstr("has no path, line, polyline, rectangle or circle that can be seen"));
  EXPECT_THAT(refusal(drawing("<g id=\"walls\"/><path id=\"x7\" d=\"M0 0 600 0\"/>")),
              HasSubstr("layer 'walls' is empty"));
  EXPECT_THAT(refusal(drawing("<path id=\"x7\" d=\"M0 0 600 0\"/>")),
              HasSubstr("no layer is known to hold walls; its layers are x7."));
  EXPECT_THAT(refusal(drawing("<polygon id=\"wall\" points=\"0,0 600,0 0,400 600,400\"/>")),
              HasSubstr("an outline of layer 'wall' crosses itself, between 6.00, -4.00 m and "
                        "0.00, 0.00 m"));
  EXPECT_THAT(refusal(drawing("<path id=\"wall\" d=\"M0 0 L six\"/>")),
              HasSubstr("plan.svg:3:1: its d=\"\" is no path"));
  EXPECT_THAT(refusal(drawing("<polyline id=\"wall\" points=\"0,0 600\"/>")),
              HasSubstr("no list of pairs of numbers"));
  EXPECT_THAT(refusal(drawing("<g transform=\"turn(3)\"><path d=\"M0 0 1 1\"/></g>")),
              HasSubstr("'turn(3)' is no transform"));
  EXPECT_THAT(refusal(drawing("<rect id=\"wall\" width=\"50%\" height=\"4\"/>")),
              HasSubstr("width=\"50%\" is no length"));
  EXPECT_THAT(
      refusal(drawing("<g transform=\"scale(1e308)\"><path id=\"wall\" d=\"M0 0 H1e9\"/></g>")),
      HasSubstr("not a finite number"));
}

TEST_F(Svg, DrawingsWithinADrawingHaveTheirViewports) {
  const auto size = [&](const std::string& content) {
    const auto result = imported(drawing(content));
    EXPECT_TRUE(result) << result.error().message;
    return result ? result->bounds.size() : Vec3d{};
  };
  const std::string within = R"(<rect id="wall" x="5" width="40" height="30"/></svg>)";
  const Vec3d whole =
      size(R"(<svg x="100" width="400" height="300" viewBox="0 0 40 30">)" + within);
  EXPECT_NEAR(whole.x, 4.0, 1e-9);
  EXPECT_NEAR(whole.y, 3.0, 1e-9);
  const Vec3d stretched = size(
      R"(<svg width="800" height="300" viewBox="0 0 40 30" preserveAspectRatio="none">)" + within);
  EXPECT_NEAR(stretched.x, 8.0, 1e-9);
  const Vec3d unsized = size(R"(<svg width="100%" viewBox="0 0 400 300"><rect id="wall" width="400"
                             height="300"/></svg>)");
  EXPECT_NEAR(unsized.x, 4.0, 1e-9);
  const Vec3d symbol = size(
      R"(<symbol id="s" viewBox="0 0 2 2"><rect id="wall" width="2" height="2"/></symbol>
         <use href="#s" width="400" height="600"/>)");
  EXPECT_NEAR(symbol.x, 4.0, 1e-9);
  EXPECT_NEAR(symbol.y, 4.0, 1e-9);
}

// Each group uses the next one ten times, and the last one the first.
TEST_F(Svg, RefusesUsesNestedTooDeeply) {
  std::string content;
  for (int i = 0; i < 9; ++i) {
    content += fmt::format("<g id=\"g{}\">", i);
    for (int k = 0; k < 10; ++k) {
      content += fmt::format("<use href=\"#g{}\"/>", (i + 1) % 9);
    }
    content += "</g>";
  }
  EXPECT_THAT(refusal(drawing(content)), HasSubstr("more points than a plan of rooms"));
  std::string deep;
  for (int i = 0; i < 20'000; ++i) {
    deep += "<g>";
  }
  deep += "<path d=\"M0 0 1 1\"/>";
  for (int i = 0; i < 20'000; ++i) {
    deep += "</g>";
  }
  EXPECT_THAT(refusal(drawing(deep)), HasSubstr("has no path"));
}

TEST(SvgText, PathsAreReadAsTheStandardWritesThem) {
  const auto both = svg_path("M1-2l3 4.5.5.5h-1V0zm10 0 1,1 M5,5z");
  ASSERT_TRUE(both);
  ASSERT_EQ(both->size(), 2U);
  EXPECT_EQ((*both)[0].points,
            (std::vector<FloorPoint>{{1, -2}, {4, 2.5}, {4.5, 3}, {3.5, 3}, {3.5, 0}}));
  EXPECT_TRUE((*both)[0].is_closed);
  EXPECT_FALSE((*both)[1].is_closed);
  EXPECT_EQ((*both)[1].points, (std::vector<FloorPoint>{{11, -2}, {12, -1}}));
  // Flags of an arc need no space behind them.
  const auto arc = svg_path("M0 0a5 5 0 0110 0");
  ASSERT_TRUE(arc);
  EXPECT_EQ(arc->at(0).points.back(), (FloorPoint{10, 0}));
  // The four arcs of a radius of 5 between two points, by their farthest corners (SVG 1.1, 8.3.8).
  const auto reach = [](const char* flags) {
    const auto path = svg_path(fmt::format("M0 0A5 5 0 {} 6 0", flags));
    double low = 0.0;
    double high = 0.0;
    for (const FloorPoint& p : path->at(0).points) {
      const double below = std::abs(std::hypot(p[0] - 3, p[1] - 4) - 5);
      const double above = std::abs(std::hypot(p[0] - 3, p[1] + 4) - 5);
      EXPECT_LT(std::min(below, above), 1e-9);
      low = std::min(low, p[1]);
      high = std::max(high, p[1]);
    }
    return std::pair(low, high);
  };
  EXPECT_NEAR(reach("0 1").first, -1.0, 0.03);
  EXPECT_NEAR(reach("1 1").first, -9.0, 0.03);
  EXPECT_NEAR(reach("0 0").second, 1.0, 0.03);
  EXPECT_NEAR(reach("1 0").second, 9.0, 0.03);
  // Rotated by a quarter, its long axis is vertical; radii that are too small grow.
  const auto upright = svg_path("M0 0A2 1 90 0 1 2 0");
  EXPECT_NEAR(upright->at(0).points.at(upright->at(0).points.size() / 2)[1], -2.0, 0.02);
  EXPECT_EQ(svg_path("M0 0A0 1 0 0 1 2 0")->at(0).points.size(), 2U);
  // A circle of which a number cannot state the bend is a line.
  EXPECT_EQ(svg_path("M0 0A1e300 1e300 0 0 1 1e-10 0")->at(0).points,
            (std::vector<FloorPoint>{{0, 0}, {1e-10, 0}}));
  // A quarter of a circle of radius 1 stays one, to half a percent.
  const double k = 0.5522847498;
  const auto curve = svg_path(fmt::format("M1 0C1 {} {} 1 0 1S-1 {} -1 0", k, k, k));
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->at(0).points.size(), 1U + 2 * kPieces);
  for (const FloorPoint& p : curve->at(0).points) {
    EXPECT_NEAR(std::hypot(p[0], p[1]), 1.0, 0.005);
  }
  // A parabola through its middle.
  const auto parabola = svg_path("M0 0Q1 2 2 0T4 0");
  ASSERT_TRUE(parabola);
  EXPECT_NEAR(parabola->at(0).points.at(kPieces / 2)[1], 1.0, 1e-12);
  EXPECT_NEAR(parabola->at(0).points.at(kPieces + kPieces / 2)[1], -1.0, 1e-12);
  for (const char* wrong : {"5 5",
                            "M",
                            "M1",
                            "M0 0L1",
                            "M0 0X1 1",
                            "M0 0z 1 1",
                            "M0 0a1 1 0 2 0 1 1",
                            "M0 0 1e999 1"}) {
    EXPECT_FALSE(svg_path(wrong)) << wrong;
  }
}

TEST(SvgText, TransformsAreTakenFromTheInside) {
  const auto placing = svg_transform("translate(10,20) rotate(90) scale(2 -1)");
  ASSERT_TRUE(placing);
  const FloorPoint at = (*placing)({1, 3});
  EXPECT_NEAR(at[0], 13.0, 1e-12);
  EXPECT_NEAR(at[1], 22.0, 1e-12);
  const auto about = svg_transform("rotate(180, 1, 1)");
  ASSERT_TRUE(about);
  EXPECT_NEAR((*about)({3, 1})[0], -1.0, 1e-12);
  EXPECT_EQ((*svg_transform("matrix(1 2 3 4 5 6)"))({1, 1}), (FloorPoint{9, 12}));
  EXPECT_NEAR((*svg_transform("skewX(45)"))({0, 1})[0], 1.0, 1e-12);
  for (const char* wrong : {"turn(1)", "rotate(1,2)", "scale", "scale(1", "matrix(1)"}) {
    EXPECT_FALSE(svg_transform(wrong)) << wrong;
  }
}

TEST(SvgText, LengthsIncludeTheirUnit) {
  EXPECT_NEAR(svg_length("2.5cm")->metres(), 0.025, 1e-15);
  EXPECT_EQ(svg_length(" 80% ")->metres(), 0.0);
  EXPECT_EQ(svg_length("12px")->number, 12.0);
  EXPECT_FALSE(svg_length("wide"));
  EXPECT_FALSE(svg_length("1 2"));
}

}  // namespace
}  // namespace rayloc::svg_test
