// Curves of a DXF as chords, and in a drawing.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/dxf/dxf_curves.h"
#include "daemon/site/import/dxf/dxf_reader.h"
#include "tests/daemon/site/import/import_files.h"

namespace rayloc::dxf_curves_test {
namespace {

constexpr double kTight = 1e-9;

double distance(const FloorPoint& a, const FloorPoint& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

TEST(DxfCurves, ABulgeIsAnArcAboutItsCentre) {
  // Half a turn, anticlockwise from 0, 0 to 2, 0: below the chord, about 1, 0.
  const std::vector<FloorPoint> half = corners_of({{{0, 0}, 1.0}, {{2, 0}}}, false);
  ASSERT_EQ(half.size(), 17U);
  for (const FloorPoint& p : half) {
    EXPECT_NEAR(distance(p, {1, 0}), 1.0, kTight);
    EXPECT_LE(p[1], kTight);
  }
  EXPECT_NEAR(half.back()[0], 2.0, kTight);
  // Clockwise it is above the chord; three quarters of a turn reach beyond it.
  for (const FloorPoint& p : corners_of({{{0, 0}, -1.0}, {{2, 0}}}, false)) {
    EXPECT_GE(p[1], -kTight);
  }
  const double long_bulge = std::tan(3.0 * std::numbers::pi / 8.0);
  double lowest = 0.0;
  for (const FloorPoint& p : corners_of({{{0, 0}, long_bulge}, {{2, 0}}}, false)) {
    EXPECT_NEAR(distance(p, {1, -1}), std::numbers::sqrt2, kTight);
    lowest = std::min(lowest, p[1]);
  }
  EXPECT_NEAR(lowest, -1.0 - std::numbers::sqrt2, 0.02);
}

TEST(DxfCurves, TheLastCornerOfAClosedLineHasAnArc) {
  const std::vector<DxfVertex> circle = {{{0, 0}, 1.0}, {{2, 0}, 1.0}};
  EXPECT_EQ(corners_of(circle, true).size(), 32U);
  EXPECT_EQ(corners_of(circle, false).size(), 17U);
  for (const FloorPoint& p : corners_of(circle, true)) {
    EXPECT_NEAR(distance(p, {1, 0}), 1.0, kTight);
  }
}

TEST(DxfCurves, BulgesOutsideTheirRangeAreChords) {
  for (const double bulge : {0.0, 1e-300, -1e-300, 1e-7, 1e7, 1e300}) {
    EXPECT_EQ(corners_of({{{0, 0}, bulge}, {{2, 0}}}, false).size(), 2U) << bulge;
  }
  EXPECT_EQ(corners_of({{{-1e308, 0}, 1.0}, {{1e308, 0}}}, false).size(), 2U);
}

TEST(DxfCurves, ArcsRunAnticlockwiseFromTheirBeginToTheirEnd) {
  constexpr double kQuarter = std::numbers::pi / 2.0;
  // From 270 degrees over 0 to 90.
  const std::vector<FloorPoint> right = points_of({{1, 2}, {3, 0}, 1.0, 3 * kQuarter, kQuarter});
  ASSERT_EQ(right.size(), 17U);
  EXPECT_NEAR(right.front()[1], -1.0, kTight);
  EXPECT_NEAR(right.at(8)[0], 4.0, kTight);
  EXPECT_NEAR(right.back()[1], 5.0, kTight);
  // Half as high, and the other side if its axis points down.
  const std::vector<FloorPoint> flat = points_of({{0, 0}, {2, 0}, -0.5, 0.0, kQuarter});
  EXPECT_NEAR(flat.back()[0], 0.0, kTight);
  EXPECT_NEAR(flat.back()[1], -1.0, kTight);
  EXPECT_TRUE(is_whole({{0, 0}, {1, 0}, 1.0, 0.0, 4 * kQuarter}));
  EXPECT_FALSE(is_whole({{0, 0}, {1, 0}, 1.0, 0.0, 3 * kQuarter}));
  EXPECT_EQ(points_of({{0, 0}, {1, 0}}).size(), 32U);
  // A turn in text is rounded.
  for (const double turn : {6.28319, 6.283185, 6.2832, 6.2831}) {
    EXPECT_TRUE(is_whole({{0, 0}, {1, 0}, 1.0, 0.0, turn})) << turn;
    EXPECT_EQ(points_of({{0, 0}, {1, 0}, 1.0, 1.0, 1.0 + turn}).size(), 32U) << turn;
  }
  EXPECT_FALSE(is_whole({{0, 0}, {1, 0}, 1.0, 0.0, 6.28}));
  // Angles of any size are those of a turn.
  EXPECT_LE(points_of({{0, 0}, {1, 0}, 1.0, -1e308, 1e308}).size(), 33U);
}

class DxfDrawing : public test::ImportFiles {
 protected:
  Drawing drawn(const std::string& entities) const {
    const auto drawing =
        read_dxf(file("plan.dxf", "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n"));
    EXPECT_TRUE(drawing) << drawing.error().message;
    return drawing ? *drawing : Drawing{};
  }
};

TEST_F(DxfDrawing, HasTheCurvesOfEachEntity) {
  const Drawing drawing = drawn(
      "0\nCIRCLE\n8\nround\n10\n5\n20\n1\n40\n2\n"
      "0\nARC\n8\nround\n10\n5\n20\n1\n40\n2\n50\n350\n51\n10\n"
      "0\nELLIPSE\n8\nlong\n10\n0\n20\n0\n11\n0\n21\n4\n40\n0.5\n41\n0\n42\n3.14159265358979\n"
      "0\nLWPOLYLINE\n8\nlw\n70\n0\n10\n0\n20\n0\n42\n1\n10\n2\n20\n0\n"
      "0\nPOLYLINE\n8\nold\n70\n0\n0\nVERTEX\n10\n0\n20\n0\n42\n1\n0\nVERTEX\n10\n2\n20\n0\n0\nSEQE"
      "ND\n");
  ASSERT_EQ(drawing.lines.size(), 5U);
  EXPECT_TRUE(drawing.remarks.empty());
  EXPECT_TRUE(drawing.lines[0].is_closed);
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_EQ(drawing.lines[i].layer, "round");
    for (const FloorPoint& p : drawing.lines[i].points) {
      EXPECT_NEAR(distance(p, {5, 1}), 2.0, kTight);
    }
  }
  EXPECT_FALSE(drawing.lines[1].is_closed);
  EXPECT_NEAR(
      drawing.lines[1].points.front()[1], 1.0 - 2.0 * std::sin(std::numbers::pi / 18.0), kTight);
  // Its major axis points up, so that half a turn goes over the left side.
  EXPECT_NEAR(drawing.lines[2].points.front()[1], 4.0, kTight);
  EXPECT_NEAR(drawing.lines[2].points.at(8)[0], -2.0, kTight);
  EXPECT_EQ(drawing.lines[3].points.size(), 17U);
  EXPECT_EQ(drawing.lines[4].points.size(), 17U);
  for (std::size_t i = 0; i < drawing.lines[3].points.size(); ++i) {
    EXPECT_NEAR(distance(drawing.lines[3].points[i], drawing.lines[4].points[i]), 0.0, kTight);
  }
}

std::string in_block(const std::string& entities) {
  return "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nb\n10\n1\n20\n0\n" + entities +
         "0\nENDBLK\n0\nENDSEC\n";
}

// Three columns and two rows, rotated by a quarter: columns go up, rows to the left.
TEST_F(DxfDrawing, AnArrayOfABlockIsDrawnAsOftenAsItIsStated) {
  const auto drawing =
      read_dxf(file("plan.dxf",
                    in_block("0\nLINE\n8\ndesk\n10\n1\n20\n0\n11\n2\n21\n0\n") +
                        "0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nb\n10\n10\n20\n20\n41\n2\n50\n90\n"
                        "70\n3\n71\n2\n44\n5\n45\n7\n0\nENDSEC\n0\nEOF\n"));
  ASSERT_TRUE(drawing) << drawing.error().message;
  ASSERT_EQ(drawing->lines.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t row = i / 3;
    const FloorPoint first{10.0 - 7.0 * static_cast<double>(row),
                           20.0 + 5.0 * static_cast<double>(i % 3)};
    EXPECT_NEAR(distance(drawing->lines[i].points[0], first), 0.0, kTight) << i;
    EXPECT_NEAR(distance(drawing->lines[i].points[1], {first[0], first[1] + 2.0}), 0.0, kTight);
  }
}

TEST_F(DxfDrawing, AnArrayOfTooManyBlocksIsRefused) {
  const auto drawing = read_dxf(file("plan.dxf",
                                     in_block("0\nLINE\n8\ndesk\n10\n1\n11\n2\n") +
                                         "0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nb\n70\n30000\n71\n"
                                         "30000\n0\nENDSEC\n0\nEOF\n"));
  ASSERT_FALSE(drawing);
  EXPECT_NE(drawing.error().message.find("more points than"), std::string::npos);
  const auto beyond = read_dxf(
      file("plan.dxf", "0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nb\n70\n70000\n0\nENDSEC\n0\nEOF\n"));
  ASSERT_FALSE(beyond);
  EXPECT_NE(beyond.error().message.find("plan.dxf:9: '70000'"), std::string::npos)
      << beyond.error().message;
}

// A block of 3000 kinds that are not read, placed a thousand times.
TEST_F(DxfDrawing, PlacedBlocksOfManyKindsThatAreNotReadAreRefused) {
  std::string unread;
  for (int i = 0; i < 3000; ++i) {
    unread += fmt::format("0\nX{}\n8\na\n", i);
  }
  const auto placed = [&](int columns) {
    return read_dxf(file("plan.dxf",
                         in_block(unread + "0\nLINE\n8\na\n11\n1\n") +
                             fmt::format("0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nb\n70\n{}\n0\n"
                                         "ENDSEC\n0\nEOF\n",
                                         columns)));
  };
  EXPECT_TRUE(placed(10));
  const auto many = placed(1000);
  ASSERT_FALSE(many);
  EXPECT_NE(many.error().message.find("more points than"), std::string::npos);
}

// Seen from below, the x axis of the entity's own plane points to the left.
TEST_F(DxfDrawing, EntitiesOfAPlaneThatPointsDownAreMirrored) {
  const std::string down = "210\n0\n220\n0\n230\n-1\n";
  const std::string upright = "210\n0\n220\n1\n230\n0\n";
  const std::string polyline = "0\nLWPOLYLINE\n8\na\n10\n1\n20\n2\n10\n3\n20\n2\n";
  const std::string line = "0\nLINE\n8\na\n10\n1\n20\n2\n11\n3\n21\n2\n";
  const std::string arc = "0\nARC\n8\na\n10\n5\n20\n0\n40\n1\n50\n0\n51\n90\n";
  const Drawing drawing =
      drawn(polyline + down + line + down + arc + down + polyline + upright + line + upright);
  ASSERT_EQ(drawing.lines.size(), 4U);
  EXPECT_EQ(drawing.lines[0].points[0], (FloorPoint{-1.0, 2.0}));
  EXPECT_EQ(drawing.lines[1].points[0], (FloorPoint{1.0, 2.0})) << "its ends are in the drawing";
  EXPECT_NEAR(distance(drawing.lines[2].points.front(), {-6, 0}), 0.0, kTight);
  EXPECT_NEAR(distance(drawing.lines[2].points.back(), {-5, 1}), 0.0, kTight);
  ASSERT_EQ(drawing.remarks.size(), 1U);
  EXPECT_NE(drawing.remarks[0].find("1 in a plane that is not level"), std::string::npos);

  const auto inserted =
      read_dxf(file("plan.dxf",
                    in_block("0\nLINE\n8\na\n10\n1\n20\n0\n11\n2\n21\n0\n") +
                        "0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nb\n10\n4\n20\n0\n" + down +
                        "0\nENDSEC\n0\nEOF\n"));
  ASSERT_TRUE(inserted) << inserted.error().message;
  EXPECT_NEAR(distance(inserted->lines.at(0).points[0], {-4, 0}), 0.0, kTight);
  EXPECT_NEAR(distance(inserted->lines.at(0).points[1], {-5, 0}), 0.0, kTight);
}

TEST_F(DxfDrawing, MeshesAndControlPointsAreNoLines) {
  const auto at = [](int x, int flags) {
    return fmt::format("0\nVERTEX\n10\n{}\n20\n0\n70\n{}\n", x, flags);
  };
  const Drawing drawing =
      drawn("0\nPOLYLINE\n8\na\n70\n64\n" + at(0, 192) + at(1, 192) + "0\nSEQEND\n" +
            "0\nPOLYLINE\n8\na\n70\n4\n" + at(0, 8) + at(9, 16) + at(1, 8) + "0\nSEQEND\n");
  ASSERT_EQ(drawing.lines.size(), 1U);
  EXPECT_EQ(drawing.lines[0].points, (std::vector<FloorPoint>{{0, 0}, {1, 0}}));
  ASSERT_EQ(drawing.remarks.size(), 1U);
  EXPECT_NE(drawing.remarks[0].find("1 POLYLINE that is a mesh"), std::string::npos);
}

TEST_F(DxfDrawing, APolylineInSpaceHasThePointsOfTheDrawing) {
  const auto polyline = [](int flags) {
    return fmt::format(
        "0\nPOLYLINE\n8\na\n70\n{}\n230\n-1\n0\nVERTEX\n10\n1\n20\n0\n70\n32\n"
        "0\nVERTEX\n10\n5\n20\n0\n70\n32\n0\nSEQEND\n",
        flags);
  };
  const Drawing drawing = drawn(polyline(8) + polyline(0));
  ASSERT_EQ(drawing.lines.size(), 2U);
  EXPECT_EQ(drawing.lines[0].points[1], (FloorPoint{5, 0}));
  EXPECT_EQ(drawing.lines[1].points[1], (FloorPoint{-5, 0}));
}

TEST_F(DxfDrawing, EntitiesThatAreNoLinesAreCounted) {
  const std::string line = "0\nLINE\n8\na\n11\n1\n";
  const Drawing drawing = drawn(line + "0\nLWPOLYLINE\n8\na\n10\n1\n20\n1\n");
  EXPECT_EQ(drawing.lines.size(), 1U);
  ASSERT_EQ(drawing.remarks.size(), 1U);
  EXPECT_NE(drawing.remarks[0].find("1 line without a second point"), std::string::npos);
  const auto nested = read_dxf(file("plan.dxf",
                                    in_block(line + "0\nINSERT\n2\nb\n") +
                                        "0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nb\n0\nINSERT\n2\n"
                                        "c\n0\nENDSEC\n0\nEOF\n"));
  ASSERT_TRUE(nested) << nested.error().message;
  EXPECT_EQ(nested->lines.size(), 16U);
  ASSERT_EQ(nested->remarks.size(), 1U);
  EXPECT_NE(nested->remarks[0].find("1 INSERT in too many blocks"), std::string::npos);
  EXPECT_NE(nested->remarks[0].find("1 INSERT of a block that is not there"), std::string::npos);
}

TEST_F(DxfDrawing, RefusesAFileThatIsCutOff) {
  const std::string begin = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\na\n11\n1\n";
  const auto cut = read_dxf(file("plan.dxf", begin));
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().message.find("plan.dxf:11: the file ends within"), std::string::npos)
      << cut.error().message;
  EXPECT_TRUE(read_dxf(file("plan.dxf", begin + "0\nENDSEC\n")));
  const auto unclosed = read_dxf(file("plan.dxf", begin + "0\nEOF\n"));
  ASSERT_TRUE(unclosed);
  EXPECT_TRUE(unclosed->remarks.empty());
}

TEST_F(DxfDrawing, AMarkOfTheByteOrderIsSkipped) {
  EXPECT_TRUE(read_dxf(file("plan.dxf",
                            "\xef\xbb\xbf"
                            "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\na\n11\n1\n0\nENDSEC\n0\nEOF\n")));
}

TEST_F(DxfDrawing, UnitsOfBuildingsAreThoseOfTheHeader) {
  for (const auto& [number, metres] : {std::pair{1, 0.0254},
                                       {2, 0.3048},
                                       {4, 0.001},
                                       {6, 1.0},
                                       {10, 0.9144},
                                       {14, 0.1},
                                       {21, 1200.0 / 3937.0},
                                       {22, 100.0 / 3937.0},
                                       {23, 3600.0 / 3937.0},
                                       {24, 6336000.0 / 3937.0},
                                       {0, 0.0},
                                       {3, 1609.344},
                                       {18, 0.0},
                                       {99, 0.0}}) {
    const auto drawing = read_dxf(
        file("plan.dxf",
             fmt::format("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{}\n0\nENDSEC\n0\nSECTION\n2\n"
                         "ENTITIES\n0\nLINE\n8\na\n11\n1\n0\nENDSEC\n0\nEOF\n",
                         number)));
    ASSERT_TRUE(drawing) << drawing.error().message;
    EXPECT_NEAR(drawing->metres, metres, 1e-12 * metres) << number;
    const bool is_ignored = number == 18 || number == 99;
    ASSERT_EQ(drawing->remarks.size(), is_ignored ? 1U : 0U) << number;
    EXPECT_TRUE(!is_ignored ||
                drawing->remarks[0].find(fmt::format("$INSUNITS {} ", number)) != std::string::npos)
        << number;
  }
}

// The two faces of a wall about one centre, 20 cm apart.
TEST_F(DxfDrawing, ABentWallHasItsThickness) {
  std::string entities;
  for (const double radius : {4.0, 4.2}) {
    entities += fmt::format("0\nARC\n8\nWALL\n10\n0\n20\n0\n40\n{}\n50\n0\n51\n90\n", radius);
  }
  const auto room =
      import(file("plan.dxf", "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n"));
  ASSERT_TRUE(room) << room.error().message;
  std::size_t walls = 0;
  for (const StatedObject& object : room->scene.objects) {
    walls += object.name.starts_with("WALL") ? 1U : 0U;
  }
  EXPECT_EQ(walls, 8U) << "one sheet for each pair of chords";
  EXPECT_NE(remarks(*room).find("8 pieces of wall, 8 of them with both faces"), std::string::npos)
      << remarks(*room);
}

}  // namespace
}  // namespace rayloc::dxf_curves_test
