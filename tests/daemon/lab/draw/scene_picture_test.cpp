#include "daemon/lab/draw/scene_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <cairo.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "daemon/lab/draw/png.h"
#include "daemon/lab/draw/svg.h"
#include "daemon/site/plan/palette.h"
#include "engine/scene/read/load_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::draw::scene_picture_test {
namespace {

std::shared_ptr<const Scene> meeting_room() {
  auto scene = load_scene(test::data_path("/sites/meeting_room/scene.xml"), {test::kCarrier, {}});
  EXPECT_TRUE(scene);
  return std::make_shared<const Scene>(*std::move(scene));
}

ScenePicture picture_of(const Scene& scene) {
  ScenePicture picture;
  picture.scene = &scene;
  picture.title = "a <room> & more";
  picture.marks = {{"tx", MarkKind::kTransmitter, {{0.5, 0.25, 1.2}}, {}},
                   {"rx", MarkKind::kReceiver, {{-1.0, -0.5, 1.2}}, {}}};
  picture.paths = {{{{0.5, 0.25, 1.2}, {-1.0, -0.5, 1.2}}, -50.0},
                   {{{0.5, 0.25, 1.2}, {0.0, 1.4, 1.3}, {-1.0, -0.5, 1.2}}, -70.0}};
  picture.strongest_db = -50.0;
  picture.weakest_db = -90.0;
  return picture;
}

template <typename T>
std::vector<T> all_of(const Drawing& drawing) {
  std::vector<T> found;
  for (const Shape& shape : drawing.shapes) {
    if (const T* one = std::get_if<T>(&shape)) {
      found.push_back(*one);
    }
  }
  return found;
}

std::set<std::string> texts_of(const Drawing& drawing) {
  std::set<std::string> texts;
  for (const Text& text : all_of<Text>(drawing)) {
    texts.insert(text.text);
  }
  return texts;
}

// The last circle of that colour: the symbol in the legend comes after the one in the room.
PagePoint symbol(const Drawing& drawing, const Colour& colour) {
  for (const Circle& circle : all_of<Circle>(drawing)) {
    if (circle.fill == colour) {
      return circle.centre;
    }
  }
  ADD_FAILURE() << "no such symbol";
  return {};
}

double apart(const PagePoint& a, const PagePoint& b) { return std::hypot(a.x - b.x, a.y - b.y); }

// Pixels a metre by the scale bar: the line above the text "LENGTH m...".
double pixels_per_metre(const Drawing& drawing) {
  for (std::size_t i = 0; i < drawing.shapes.size(); ++i) {
    const auto* text = std::get_if<Text>(&drawing.shapes[i]);
    if (text != nullptr && text->text == "Scale") {
      const auto& bar = std::get<Line>(drawing.shapes.at(i + 1));
      const auto& length = std::get<Text>(drawing.shapes.at(i + 4));
      return apart(bar.points[0], bar.points[1]) / std::stod(length.text);
    }
  }
  ADD_FAILURE() << "no scale bar";
  return 1.0;
}

TEST(ScenePicture, PlanLabelsObjectsAndMaterials) {
  const auto scene = meeting_room();
  const std::set<std::string> texts = texts_of(draw_scene(picture_of(*scene), View::kPlan));
  for (const char* text : {"a <room> & more",
                           "tx",
                           "rx",
                           "table",
                           "cabinet",
                           "whiteboard",
                           "window",
                           "door",
                           "chair0_seat",
                           "wall_north",
                           "wall_west",
                           "wood",
                           "concrete",
                           "Power of a path",
                           "-50 dB",
                           "-90 dB"}) {
    EXPECT_TRUE(texts.contains(text)) << text;
  }
}

TEST(ScenePicture, PlanIsToTheScaleOfItsBar) {
  const auto scene = meeting_room();
  const Drawing plan = draw_scene(picture_of(*scene), View::kPlan);
  EXPECT_NEAR(
      apart(symbol(plan, kTransmitterInk), symbol(plan, kReceiverInk)) / pixels_per_metre(plan),
      std::hypot(1.5, 0.75),
      1e-9);
}

TEST(ScenePicture, IsometricViewIsToScaleAlongEachAxis) {
  const auto scene = meeting_room();
  for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
    ScenePicture picture = picture_of(*scene);
    picture.marks[1].antennas = {picture.marks[0].antennas[0] + 0.6 * axis};
    const Drawing view = draw_scene(picture, View::k3d);
    EXPECT_NEAR(
        apart(symbol(view, kTransmitterInk), symbol(view, kReceiverInk)) / pixels_per_metre(view),
        0.6,
        1e-9);
  }
}

TEST(ScenePicture, PathsGoFromEndToEndTheStrongestLastAndDarkest) {
  const auto scene = meeting_room();
  for (const View view : {View::kPlan, View::k3d}) {
    const Drawing drawing = draw_scene(picture_of(*scene), view);
    std::vector<Line> paths;
    for (const Line& line : all_of<Line>(drawing)) {
      if (line.points.front() == symbol(drawing, kTransmitterInk) &&
          line.points.back() == symbol(drawing, kReceiverInk)) {
        paths.push_back(line);
      }
    }
    ASSERT_EQ(paths.size(), 2U);
    EXPECT_EQ(paths[0].points.size(), 3U);
    EXPECT_EQ(paths[1].points.size(), 2U);
    EXPECT_EQ(paths[1].pen.colour, power_colour(1.0));
    EXPECT_EQ(paths[0].pen.colour, power_colour(0.5));
    EXPECT_GT(paths[1].pen.width, paths[0].pen.width);
  }
}

TEST(ScenePicture, NothingIsOutsideOfThePage) {
  const auto scene = meeting_room();
  for (const View view : {View::kPlan, View::k3d}) {
    const Drawing drawing = draw_scene(picture_of(*scene), view);
    const auto expect_inside = [&](const PagePoint& p) {
      EXPECT_TRUE(p.x >= 0.0 && p.y >= 0.0 && p.x <= drawing.width && p.y <= drawing.height)
          << p.x << ", " << p.y;
    };
    for (const Polygon& polygon : all_of<Polygon>(drawing)) {
      std::for_each(polygon.corners.begin(), polygon.corners.end(), expect_inside);
    }
    for (const Line& line : all_of<Line>(drawing)) {
      std::for_each(line.points.begin(), line.points.end(), expect_inside);
    }
    for (const Text& text : all_of<Text>(drawing)) {
      expect_inside(text.at);
    }
  }
}

TEST(ScenePicture, ZonesLieWhereTheyAreAndAreNamed) {
  const auto scene = meeting_room();
  ScenePicture picture = picture_of(*scene);
  picture.zones = {{"desk", {{-0.5, 0.0}, {1.0, 0.0}, {1.0, 0.75}}}};
  for (const View view : {View::kPlan, View::k3d}) {
    const Drawing drawing = draw_scene(picture, view);
    EXPECT_TRUE(texts_of(drawing).contains("desk"));
    const auto polygons = all_of<Polygon>(drawing);
    const auto tint = std::find_if(polygons.begin(), polygons.end(), [](const Polygon& polygon) {
      return polygon.fill == kZoneTint;
    });
    ASSERT_NE(tint, polygons.end());
    ASSERT_EQ(tint->corners.size(), 3U);
    if (view == View::kPlan) {
      EXPECT_NEAR(apart(tint->corners[0], tint->corners[1]), 1.5 * pixels_per_metre(drawing), 1e-6);
      EXPECT_LT(tint->corners[2].y, tint->corners[1].y);  // +y is up
    }
  }
}

TEST(ScenePicture, SceneWithoutFloorOrDepthIsDrawn) {
  const auto sheet = test::make_scene(
      {{"screen", test::rectangle_mesh({0, 0, 0}, {2, 0, 0}, {0, 0, 1})}}, test::kConcrete);
  for (const View view : {View::kPlan, View::k3d}) {
    ScenePicture picture;
    picture.scene = sheet.get();
    const Drawing drawing = draw_scene(picture, view);
    EXPECT_TRUE(std::isfinite(drawing.width) && std::isfinite(drawing.height));
    EXPECT_FALSE(all_of<Line>(drawing).empty());
  }
}

TEST(Svg, IsWellFormedAndHasOneElementAShape) {
  const auto scene = meeting_room();
  const Drawing drawing = draw_scene(picture_of(*scene), View::k3d);
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(to_svg(drawing).c_str()));
  const pugi::xml_node root = document.child("svg");
  EXPECT_EQ(std::string(root.attribute("width").value()),
            std::to_string(std::lround(drawing.width)));
  const auto elements = std::distance(root.begin(), root.end());
  EXPECT_EQ(static_cast<std::size_t>(elements), drawing.shapes.size() + 1);  // the white page
  const pugi::xml_node title = root.child("text");
  EXPECT_STREQ(title.child_value(), "a <room> & more");
}

TEST(Svg, ShapesAreWrittenAsTheyAre) {
  Drawing drawing{100.0, 50.0, {}};
  drawing.shapes.emplace_back(Polygon{{{0, 0}, {10, 0}, {0, 5.5}}, {255, 0, 16, 0.5}});
  drawing.shapes.emplace_back(Line{{{1, 2}, {3, 4}}, {{0, 0, 0, 1.0}, 2.0, true}});
  drawing.shapes.emplace_back(Circle{{5, 6}, 7.0, {1, 2, 3, 1.0}, std::nullopt});
  Text text{{8, 9}, "a\tb", 10.0, {}, TextAnchor::kMiddle};
  text.degrees = 90.0;
  drawing.shapes.emplace_back(text);
  const std::string svg = to_svg(drawing);
  for (
      const char* element : {
          R"(<polygon points="0.00,0.00 10.00,0.00 0.00,5.50" fill="#ff0010" fill-opacity="0.5"/>)",
          R"(<polyline points="1.00,2.00 3.00,4.00" fill="none" stroke="#000000" )"
          R"(stroke-width="2.00" stroke-dasharray="4 3"/>)",
          R"(<circle cx="5.00" cy="6.00" r="7.00" fill="#010203"/>)",
          R"x(text-anchor="middle" transform="rotate(-90.00 8.00 9.00)">a?b</text>)x",
      }) {
    EXPECT_NE(svg.find(element), std::string::npos) << element << "\n" << svg;
  }
}

// Pixels of a PNG, read by cairo.
class Image {
 public:
  explicit Image(std::string bytes) : bytes_(std::move(bytes)) {
    surface_ = cairo_image_surface_create_from_png_stream(&Image::read, this);
  }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
  ~Image() { cairo_surface_destroy(surface_); }

  int width() const { return cairo_image_surface_get_width(surface_); }
  int height() const { return cairo_image_surface_get_height(surface_); }
  // 0xRRGGBB
  std::uint32_t at(int x, int y) const {
    const unsigned char* row =
        cairo_image_surface_get_data(surface_) +
        static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(surface_);
    const std::ptrdiff_t offset = std::ptrdiff_t{4} * x;
    return static_cast<std::uint32_t>(row[offset + 2]) << 16U |
           static_cast<std::uint32_t>(row[offset + 1]) << 8U | row[offset];
  }

 private:
  static cairo_status_t read(void* self, unsigned char* data, unsigned length) {
    auto* image = static_cast<Image*>(self);
    if (image->bytes_.size() - image->next_ < length) {
      return CAIRO_STATUS_READ_ERROR;
    }
    std::copy_n(image->bytes_.begin() + static_cast<std::ptrdiff_t>(image->next_), length, data);
    image->next_ += length;
    return CAIRO_STATUS_SUCCESS;
  }

  std::string bytes_;
  std::size_t next_ = 0;
  cairo_surface_t* surface_ = nullptr;
};

TEST(Png, ShowsTheShapesAtTheScaleAskedFor) {
  Drawing drawing{100.0, 50.0, {}};
  drawing.shapes.emplace_back(Polygon{{{10, 10}, {30, 10}, {30, 30}, {10, 30}}, {255, 0, 0, 1.0}});
  drawing.shapes.emplace_back(Line{{{50, 10}, {50, 40}}, {{0, 0, 255, 1.0}, 4.0}});
  drawing.shapes.emplace_back(Circle{{80, 25}, 10.0, {0, 255, 0, 1.0}, std::nullopt});
  const auto png = to_png(drawing, 2.0);
  ASSERT_TRUE(png) << png.error().message;
  const Image image(*png);
  EXPECT_EQ(image.width(), 200);
  EXPECT_EQ(image.height(), 100);
  EXPECT_EQ(image.at(5, 5), 0xffffffU);
  EXPECT_EQ(image.at(40, 40), 0xff0000U);
  EXPECT_EQ(image.at(100, 50), 0x0000ffU);
  EXPECT_EQ(image.at(160, 50), 0x00ff00U);
  EXPECT_EQ(image.at(160, 74), 0xffffffU);
}

TEST(Png, TooLargeIsAnError) {
  const Drawing drawing{1e5, 1e5, {}};
  const auto png = to_png(drawing, 2.0);
  ASSERT_FALSE(png);
  EXPECT_EQ(png.error().message.find("the picture cannot be painted: "), 0U);
}

TEST(Palette, StrongerIsDarker) {
  double before = 1e9;
  for (const double share : {0.0, 0.2, 0.5, 0.8, 1.0}) {
    const Colour colour = power_colour(share);
    const double brightness = 0.3 * colour.red + 0.59 * colour.green + 0.11 * colour.blue;
    EXPECT_LT(brightness, before);
    before = brightness;
  }
  EXPECT_EQ(power_colour(-1.0), power_colour(0.0));
  EXPECT_EQ(power_colour(2.0), power_colour(1.0));
}

}  // namespace
}  // namespace rayloc::draw::scene_picture_test
