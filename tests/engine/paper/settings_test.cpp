#include "engine/paper/settings.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::paper::settings_test {
namespace {

using ::testing::HasSubstr;

std::string refusal(std::string_view assignment) {
  const auto read = read_assignment(assignment);
  EXPECT_FALSE(read) << assignment;
  return read ? "" : read.error().message;
}

TEST(PaperSettings, DefaultsAreThoseOfTheDeviceBasedMethod) {
  const std::vector<std::pair<const char*, double>> paper = {{"gamma_1", 0.05},
                                                             {"gamma_2", 0.05},
                                                             {"sigma_0_squared", 1.0},
                                                             {"sigma_m", 0.01},
                                                             {"alpha", 0.2},
                                                             {"positions", 5},
                                                             {"iterations", 100},
                                                             {"rate", 0.03},
                                                             {"momentum", 0.6},
                                                             {"smoothing", 1},
                                                             {"fixed_sigma", 0}};
  for (const auto& [key, value] : paper) {
    const Setting* setting = find_setting(key);
    ASSERT_NE(setting, nullptr) << key;
    EXPECT_EQ(setting->get({}), value) << key;
  }
}

TEST(PaperSettings, PeopleHaveTheDefaultsOfTheDeviceFreeMethod) {
  const LocalizerOptions people = person_options();
  for (const Setting& setting : settings()) {
    const double expected = setting.key == "gamma_1" || setting.key == "gamma_2" ? 2.0
                            : setting.key == "sigma_0_squared"                   ? 0.1
                            : setting.key == "alpha"                             ? 1.0
                                                                                 : setting.get({});
    EXPECT_EQ(setting.get(people), expected) << setting.key;
  }
  EXPECT_THAT(settings_help(), HasSubstr("sigma_0_squared=1"));
  EXPECT_THAT(settings_help(), HasSubstr("(people: 0.1)"));
}

TEST(PaperSettings, EachSetsOnlyItsOwnOption) {
  std::set<std::string_view> keys;
  for (const Setting& setting : settings()) {
    EXPECT_TRUE(keys.insert(setting.key).second) << setting.key;
    const double before = setting.get({});
    EXPECT_GE(before, setting.min) << setting.key;
    EXPECT_LE(before, setting.max) << setting.key;
    const double other = setting.kind == SettingKind::kFlag    ? 1.0 - before
                         : setting.kind == SettingKind::kWhole ? before + 2.0
                                                               : 0.5 * before + 0.1;
    LocalizerOptions options;
    setting.set(options, other);
    for (const Setting& one : settings()) {
      EXPECT_EQ(one.get(options), one.key == setting.key ? other : one.get({}))
          << setting.key << " changes " << one.key;
    }
  }
}

TEST(PaperSettings, ReadsAssignments) {
  LocalizerOptions options;
  for (const char* text : {"alpha=0.5", "smoothing=false", "iterations=7"}) {
    const auto read = read_assignment(text);
    ASSERT_TRUE(read) << text;
    read->setting->set(options, read->value);
  }
  EXPECT_EQ(options.descent.alpha, 0.5);
  EXPECT_FALSE(options.descent.is_smoothed);
  EXPECT_EQ(options.descent.iterations, 7);
}

TEST(PaperSettings, RefuseInvalidValues) {
  EXPECT_THAT(refusal("alpha"), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(refusal("alhpa=1"), HasSubstr("did you mean 'alpha'?"));
  EXPECT_THAT(refusal("alpha=-1"), HasSubstr("a number from 0"));
  EXPECT_THAT(refusal("alpha=nan"), HasSubstr("a number from 0"));
  EXPECT_THAT(refusal("alpha=1x"), HasSubstr("a number from 0"));
  EXPECT_THAT(refusal("iterations=1.5"), HasSubstr("a whole number"));
  EXPECT_THAT(refusal("smoothing=1"), HasSubstr("true or false"));
  EXPECT_THAT(refusal("sigma_0_squared=0"), HasSubstr("sigma_0_squared"));
}

TEST(PaperSettings, HelpNamesEveryKeyWithItsDefault) {
  const std::string help = settings_help();
  for (const Setting& setting : settings()) {
    EXPECT_THAT(help,
                HasSubstr(std::string(setting.key) + "=" + setting_text(setting, setting.get({}))));
  }
  EXPECT_THAT(help, HasSubstr("smoothing=true"));
}

}  // namespace
}  // namespace rayloc::paper::settings_test
