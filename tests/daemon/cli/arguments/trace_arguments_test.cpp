// Tests how `rayloc trace` reads its arguments.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/cli/arguments/gradient_argument.h"
#include "daemon/cli/arguments/grid_argument.h"
#include "daemon/cli/arguments/number_list.h"
#include "tests/support/scenes.h"

namespace rayloc::cli::trace_arguments_test {
namespace {

TEST(NumberList, ReadsPoints) {
  EXPECT_EQ(*parse_point("--tx", "1,-2.5,3e-1"), (Vec3d{1, -2.5, 0.3}));
  EXPECT_EQ(*parse_point("--tx", "-1,0,.5"), (Vec3d{-1, 0, 0.5}));
}

TEST(NumberList, RefusesInvalidListsWithAnExample) {
  for (const char* text : {"",
                           "1",
                           "1,2",
                           "1,2,3,4",
                           "1,2,",
                           "1,,3",
                           "1, 2,3",
                           "1,2,x",
                           "1,2,3m",
                           "1,2,nan",
                           "inf,2,3"}) {
    const auto point = parse_point("--tx", text);
    ASSERT_FALSE(point) << text;
    EXPECT_EQ(point.error().kind, ErrorKind::kUsage);
    EXPECT_EQ(point.error().message,
              std::string("--tx ") + text +
                  ": write 3 numbers with commas and without blanks: --tx 1.2,-0.4,2.1");
  }
}

TEST(GridArgument, NumbersTheTonesAboutTheCentre) {
  const auto grid = parse_grid("5.19e9,312500,4");
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->tone_index, (std::vector<std::int16_t>{-2, -1, 0, 1}));
  EXPECT_DOUBLE_EQ(grid->frequency_hz(0), 5.19e9 - 625'000.0);
}

TEST(GridArgument, RefusesTonesThatAreNone) {
  for (const char* text : {"5.19e9,312500",
                           "0,312500,4",
                           "5.19e9,-1,4",
                           "5.19e9,312500,0",
                           "5.19e9,312500,1.5",
                           "5.19e9,312500,65537"}) {
    const auto grid = parse_grid(text);
    ASSERT_FALSE(grid) << text;
    EXPECT_EQ(grid.error().kind, ErrorKind::kUsage) << text;
    EXPECT_EQ(grid.error().message.find("--cfr "), 0U) << grid.error().message;
  }
}

// Two objects, of one material.
std::shared_ptr<const Scene> scene() {
  return test::make_scene({{"table", test::box_mesh({0, 0, 0}, {1, 1, 1})},
                           {"wall", test::rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 0, 3})}},
                          test::kConcrete);
}

TEST(GradientArgument, SelectsTheParametersBehindPower) {
  const auto parameters = parse_gradient("power:rx.1,wall.2", *scene());
  ASSERT_TRUE(parameters) << parameters.error().message;
  ASSERT_EQ(parameters->size(), 2U);
  EXPECT_EQ((*parameters)[0].name, "rx.1");
  EXPECT_EQ((*parameters)[1].parameter, Parameter::object_translation(1, 2));
}

TEST(GradientArgument, RefusesUnknownNames) {
  for (const char* text : {"rx",
                           "power",
                           "power:",
                           "loss:rx",
                           "power:rx,",
                           "power:rx.3",
                           "power:rx_gain.0",
                           "power:tabel",
                           "power:eps_r.wood",
                           "power:sigma.",
                           "power:offset.tabel"}) {
    const auto parameters = parse_gradient(text, *scene());
    ASSERT_FALSE(parameters) << text;
    EXPECT_EQ(parameters.error().kind, ErrorKind::kUsage) << text;
    EXPECT_EQ(parameters.error().message.find("--gradient: "), 0U) << parameters.error().message;
  }
}

}  // namespace
}  // namespace rayloc::cli::trace_arguments_test
