#include "daemon/methods/method_registry.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/paper/settings.h"

namespace rayloc::method_registry_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(MethodRegistry, HasTheRowsOfTheProductAndTheFirstIsTheDefault) {
  EXPECT_THAT(method_names(),
              ElementsAre("rayloc", "paper", "spotfi", "m3", "cifi", "widar2", "witraj", "dscp"));
  EXPECT_EQ(default_method().name, "rayloc");
  EXPECT_EQ(find_method("dummy"), nullptr);
  EXPECT_EQ(find_method("none"), nullptr);
}

TEST(MethodRegistry, EveryRowIsCompletelyDescribed) {
  for (const Method* method : methods()) {
    EXPECT_EQ(find_method(method->name), method);
    EXPECT_FALSE(method->summary.empty()) << method->name;
    EXPECT_FALSE(method->domain.empty()) << method->name;
    EXPECT_TRUE(method->create_device != nullptr || method->create_person != nullptr)
        << method->name << " locates nothing";
    std::set<std::string_view> keys;
    for (const MethodSetting& setting : method->settings) {
      EXPECT_TRUE(keys.insert(setting.key).second) << method->name << " " << setting.key;
      EXPECT_TRUE(method->has_setting(setting.key)) << setting.key;
      EXPECT_FALSE(setting.meaning.empty()) << setting.key;
    }
    EXPECT_FALSE(method->has_setting("no such key"));
    EXPECT_THAT(methods_help(),
                HasSubstr(std::string(method->name) + ": " + std::string(method->summary)));
  }
}

TEST(MethodRegistry, PaperHasAllOfItsSettings) {
  const Method& paper = *find_method("paper");
  for (const paper::Setting& setting : paper::settings()) {
    EXPECT_TRUE(paper.has_setting(setting.key)) << setting.key;
  }
  EXPECT_FALSE(paper.has_setting("likelihood"));
  EXPECT_TRUE(find_method("rayloc")->has_setting("likelihood"));
}

}  // namespace
}  // namespace rayloc::method_registry_test
