#include "daemon/site/import/import_request.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/import/imported_site.h"

namespace rayloc::import_request_test {
namespace {

using ::testing::HasSubstr;

std::string refusal_of(const ImportRequest& request) {
  const auto options = import_options(request);
  return options ? "" : options.error().message;
}

TEST(ImportRequest, StatesUnitAxisAndHeights) {
  const auto options =
      import_options({.unit = "cm", .up = "z", .scale = {}, .height = 3.0, .tolerance = 0.1});
  ASSERT_TRUE(options) << options.error().message;
  EXPECT_EQ(options->units.metres, 0.01);
  EXPECT_EQ(options->units.up, 'z');
  EXPECT_EQ(options->units.height, 3.0);
  EXPECT_EQ(options->tolerance, 0.1);
  EXPECT_EQ(import_options({})->units.metres, ImportOptions().units.metres);
}

TEST(ImportRequest, InvalidValuesNameTheirOption) {
  ImportRequest request;
  request.unit = "yd";
  EXPECT_THAT(refusal_of(request), HasSubstr("--unit: 'yd'"));
  request = {};
  request.up = "x";
  EXPECT_THAT(refusal_of(request), HasSubstr("--up"));
  request = {};
  request.scale = 0.5;
  EXPECT_THAT(refusal_of(request), HasSubstr("--scale"));
  request.scale = 50.0;
  EXPECT_EQ(refusal_of(request), "");
  request.unit = "m";
  EXPECT_THAT(refusal_of(request), HasSubstr("write one of them"));
  request = {};
  request.height = 2.1;
  EXPECT_THAT(refusal_of(request), HasSubstr("--height"));
  request = {};
  request.tolerance = 0.6;
  EXPECT_THAT(refusal_of(request), HasSubstr("--tolerance"));
}

TEST(ImportedSite, HasTheSceneAndASiteFileWithItsName) {
  ImportedScene imported;
  imported.bounds = {{0.0, 0.0, 0.0}, {4.0, 3.0, 2.5}};
  const auto files = imported_site_files(imported, "office");
  EXPECT_TRUE(files.contains("scene.xml"));
  EXPECT_THAT(files.at("site.toml"), HasSubstr("name = \"office\""));
}

}  // namespace
}  // namespace rayloc::import_request_test
