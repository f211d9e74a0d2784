#include "daemon/lab/trace/named_parameters.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace rayloc::named_parameters_test {
namespace {

// Two objects, of one material.
std::shared_ptr<const Scene> scene() {
  return test::make_scene({{"table", test::box_mesh({0, 0, 0}, {1, 1, 1})},
                           {"wall", test::rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 0, 3})}},
                          test::kConcrete);
}

std::vector<std::string> names_of(const std::string& text) {
  const auto parameters = parse_parameters(text, *scene());
  std::vector<std::string> names;
  if (!parameters) {
    return {parameters.error().message};
  }
  for (const NamedParameter& each : *parameters) {
    names.push_back(each.name);
  }
  return names;
}

TEST(NamedParameters, NamesEveryAxisUnlessOneIsAskedFor) {
  EXPECT_EQ(names_of("rx"), (std::vector<std::string>{"rx.0", "rx.1", "rx.2"}));
  EXPECT_EQ(names_of("tx_orientation.1,rx_gain"),
            (std::vector<std::string>{"tx_orientation.1", "rx_gain"}));
  EXPECT_EQ(names_of("wall.2,eps_r.concrete,sigma.concrete,thickness.concrete"),
            (std::vector<std::string>{
                "wall.2", "eps_r.concrete", "sigma.concrete", "thickness.concrete"}));
  EXPECT_EQ(names_of("object.table.0"), std::vector<std::string>{"table.0"});
}

TEST(NamedParameters, ResolvesParameterNames) {
  const auto parameters =
      parse_parameters("rx.1,tx.2,rx_orientation.0,tx_gain,wall.2,sigma.concrete", *scene());
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

TEST(NamedParameters, OffsetsAreThoseOfTheSurfacesOfTheObject) {
  const auto parameters = parse_parameters("offset.wall", *scene());
  ASSERT_TRUE(parameters) << parameters.error().message;
  ASSERT_EQ(parameters->size(), 1U);
  EXPECT_EQ((*parameters)[0].name, "offset.wall.0");
  EXPECT_EQ((*parameters)[0].parameter, Parameter::surface_offset(6));
  EXPECT_EQ(parse_parameters("offset.table", *scene())->size(), 6U);
}

TEST(NamedParameters, RefuseUnknownNames) {
  for (const char* text :
       {"rx,", "rx.3", "rx_gain.0", "tabel", "eps_r.wood", "sigma.", "offset.tabel"}) {
    const auto parameters = parse_parameters(text, *scene());
    ASSERT_FALSE(parameters) << text;
    EXPECT_EQ(parameters.error().kind, ErrorKind::kUsage) << text;
  }
  EXPECT_NE(names_of("tabel")[0].find("did you mean 'table'?"), std::string::npos);
  EXPECT_NE(names_of("offset.tabel")[0].find("did you mean 'table'?"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::named_parameters_test
