// Tests how `rayloc trace` reads its arguments.
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/cli/arguments/gradient_argument.h"
#include "daemon/cli/arguments/number_list.h"
#include "tests/support/scenes.h"

namespace rayloc::cli::trace_arguments_test {
namespace {

TEST(NumberList, ReadsPoints) {
  EXPECT_EQ(*parse_point("--tx", "1,-2.5,3e-1"), (Vec3d{1, -2.5, 0.3}));
  EXPECT_EQ(*parse_point("--tx", "-1,0,.5"), (Vec3d{-1, 0, 0.5}));
}

TEST(NumberList, RefusesAnythingElseAndSaysWhatToWrite) {
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

// Two objects, of one material.
std::shared_ptr<const Scene> scene() {
  return test::make_scene({{"table", test::box_mesh({0, 0, 0}, {1, 1, 1})},
                           {"wall", test::rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 0, 3})}},
                          test::kConcrete);
}

std::vector<std::string> names_of(const std::string& text) {
  const auto parameters = parse_gradient(text, *scene());
  std::vector<std::string> names;
  if (!parameters) {
    return {parameters.error().message};
  }
  for (const NamedParameter& each : *parameters) {
    names.push_back(each.name);
  }
  return names;
}

TEST(GradientArgument, NamesEveryAxisUnlessOneIsAskedFor) {
  EXPECT_EQ(names_of("power:rx"), (std::vector<std::string>{"rx.0", "rx.1", "rx.2"}));
  EXPECT_EQ(names_of("power:tx_orientation.1,rx_gain"),
            (std::vector<std::string>{"tx_orientation.1", "rx_gain"}));
  EXPECT_EQ(names_of("power:wall.2,eps_r.concrete,sigma.concrete,thickness.concrete"),
            (std::vector<std::string>{
                "wall.2", "eps_r.concrete", "sigma.concrete", "thickness.concrete"}));
  EXPECT_EQ(names_of("power:object.table.0"), std::vector<std::string>{"table.0"});
}

TEST(GradientArgument, MeansTheParameterOfThatName) {
  const auto parameters =
      parse_gradient("power:rx.1,tx.2,rx_orientation.0,tx_gain,wall.2,sigma.concrete", *scene());
  ASSERT_TRUE(parameters) << parameters.error().message;
  const std::vector<Parameter> expected{Parameter::receiver_position(1),
                                        Parameter::transmitter_position(2),
                                        Parameter::receiver_orientation(0),
                                        Parameter::transmitter_gain(),
                                        Parameter::object_translation(1, 2),
                                        Parameter::conductivity(0)};
  ASSERT_EQ(parameters->size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ((*parameters)[i].parameter, expected[i]) << (*parameters)[i].name;
  }
}

TEST(GradientArgument, OffsetsAreThoseOfTheSurfacesOfTheObject) {
  const auto parameters = parse_gradient("power:offset.wall", *scene());
  ASSERT_TRUE(parameters) << parameters.error().message;
  ASSERT_EQ(parameters->size(), 1U);
  EXPECT_EQ((*parameters)[0].name, "offset.wall.0");
  EXPECT_EQ((*parameters)[0].parameter, Parameter::surface_offset(6));
  EXPECT_EQ(parse_gradient("power:offset.table", *scene())->size(), 6U);
}

TEST(GradientArgument, RefusesWhatItDoesNotKnow) {
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
  EXPECT_NE(names_of("power:tabel")[0].find("did you mean 'table'?"), std::string::npos);
  EXPECT_NE(names_of("power:offset.tabel")[0].find("did you mean 'table'?"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::cli::trace_arguments_test
