// Tests the errors of a wrong site.toml: the exact place, and what to write instead.
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/site/model/site_text.h"

namespace rayloc::site_errors_test {
namespace {

using testing::errors_of;
using ::testing::HasSubstr;
using testing::site_text;
using ::testing::StartsWith;

struct Case {
  const char* name;
  const char* from;   // replaced in the text ...
  const char* to;     // ... by this
  const char* begin;  // how the message begins
  const char* hint;   // what else it contains
};

class SiteError : public ::testing::TestWithParam<Case> {};

TEST_P(SiteError, ReportsThePositionAndTheRemedy) {
  const std::string errors = errors_of(site_text(GetParam().from, GetParam().to));
  EXPECT_THAT(errors, StartsWith(GetParam().begin));
  EXPECT_THAT(errors, HasSubstr(GetParam().hint));
  EXPECT_EQ(errors.find('\n'), std::string::npos) << "one mistake, one line: " << errors;
}

const auto kCases = std::to_array<Case>({
    {"Syntax", "x = [-1.765, 1.765]", "x = [-1.765, 1.765", "site.toml:5:1: not TOML: ", "']'"},
    {"UnknownKey",
     "yaw_deg",
     "yaw",
     "site.toml:18:1: unknown key 'yaw' in [[access_point]]",
     "did you mean 'yaw_deg'?"},
    {"UnknownTable",
     "[person]",
     "[persons]",
     "site.toml:37:2: unknown key 'persons'",
     "did you mean 'person'?"},
    {"UnknownNested",
     "thickness_m",
     "thickness",
     "site.toml:43:1: unknown key 'thickness' in [materials.glass]",
     "'thickness_m'"},
    {"UnknownFar",
     "[bounds]",
     "qqqq = 1\n[bounds]",
     "site.toml:3:1: unknown key 'qqqq'",
     "there are: access_point, bounds"},
    {"Missing",
     "id = \"ap1\"\n",
     "",
     "site.toml:14:1: [[access_point]] lacks 'id'",
     "id = \"ap1\""},
    {"ZoneCrossesItself",
     "polygon = [[0, 0], [1, 0], [1, 1]]",
     "polygon = [[0, 0], [1, 1], [1, 0], [0, 1]]",
     "site.toml:50:11: 'polygon' crosses itself",
     "in the order of the outline"},
    {"ZoneWithTwoCorners",
     "polygon = [[0, 0], [1, 0], [1, 1]]",
     "polygon = [[0, 0], [1, 0]]",
     "site.toml:50:11: 'polygon' has 2 points",
     "write 3 to 256 corners"},
    {"ZoneTwice",
     "[targets]",
     "[[zone]]\nname = \"desk\"\npolygon = [[0, 0], [1, 0], [1, 1]]\n[targets]",
     "site.toml:52:8: a second zone 'desk'",
     "its own name"},
    {"ZoneThatNobodyLeaves",
     "polygon = [[0, 0], [1, 0], [1, 1]]",
     "polygon = [[0, 0], [1, 0], [1, 1]]\nleave_probability = 0.7",
     "site.toml:51:21: 'leave_probability' is 0.7, not below 'enter_probability' = 0.7",
     "come and go"},
    {"ZoneNobodyCanEnter",
     "polygon = [[0, 0], [1, 0], [1, 1]]",
     "polygon = [[0, 0], [1, 0], [1, 1]]\nenter_probability = 1",
     "site.toml:51:21: 'enter_probability' is 1",
     "from 0.01 to 0.99"},
    {"ZoneWithoutPatience",
     "polygon = [[0, 0], [1, 0], [1, 1]]",
     "polygon = [[0, 0], [1, 0], [1, 1]]\ndwell_after_s = -1",
     "site.toml:51:17: 'dwell_after_s' is -1",
     "from 0 to 86400 s"},
    {"MissingAtTop",
     "name = \"meeting_room\"",
     "",
     "site.toml:1:1: the file lacks 'name'",
     "name = \"office\""},
    {"WrongType",
     "yaw_deg = -37",
     "yaw_deg = \"-37\"",
     "site.toml:18:11: 'yaw_deg' is a string",
     "a number without quotes, from -360 to 360 degrees"},
    {"WrongTable",
     "[targets]\nunlisted",
     "[[targets]]\nunlisted",
     "site.toml:51:1: 'targets' is an array",
     "[targets]"},
    {"OutOfRange",
     "yaw_deg = -37",
     "yaw_deg = 400",
     "site.toml:18:11: 'yaw_deg' is 400",
     "from -360 to 360 degrees"},
    {"NaN", "yaw_deg = -37", "yaw_deg = nan", "site.toml:18:11: 'yaw_deg' is nan", "from -360"},
    {"Infinite",
     "position = [-1.4",
     "position = [inf",
     "site.toml:17:13: an entry of 'position' is inf",
     "finite"},
    {"ArrayLength",
     "[-1.4, 1.05, 1.2]",
     "[-1.4, 1.05]",
     "site.toml:17:12: 'position' has 2 entries",
     "an array of 3 numbers: position = ["},
    {"ArrayEntry",
     "[-1.4, 1.05, 1.2]",
     "[-1.4, \"a\", 1.2]",
     "site.toml:17:19: an entry of 'position' is a string",
     "an array of 3 numbers"},
    {"Enum",
     "pattern = \"half_wave_dipole\"",
     "pattern = \"halfwave\"",
     "site.toml:21:11: 'halfwave' is no value of 'pattern'",
     "did you mean 'half_wave_dipole'?"},
    {"Format", "axcsi-v4", "axcsi", "site.toml:16:10: 'axcsi' is no value", "'axcsi-v4'"},
    {"NameWithSlash",
     "\"meeting_room\"",
     "\"a/b\"",
     "site.toml:1:8: 'name' is part of every topic",
     "without '/'"},
    {"EmptyName", "\"meeting_room\"", "\"\"", "site.toml:1:8: 'name' is empty", "write a text"},
    {"SceneMissing",
     "scene.xml",
     "scenes.xml",
     "site.toml:2:9: 'scene': no file scenes.xml",
     "relative to the folder"},
    {"BoundsSwapped",
     "z = [0, 2.7]",
     "z = [2.7, 0]",
     "site.toml:6:5: 'z' is [2.7, 0]",
     "[smallest, largest]"},
    {"Bandwidth",
     "bandwidth_mhz = 40",
     "bandwidth_mhz = 41",
     "site.toml:9:17: 'bandwidth_mhz' is 41",
     "20, 40, 80 or 160"},
    {"Tones", "tones = 128", "tones = 64", "site.toml:11:9: 'tones' is 64", "hold 128 tones"},
    {"ActiveOrder",
     "[[-58, -2], [2, 58]]",
     "[[2, 58], [-58, -2]]",
     "site.toml:13:10: 'active' has [-58, -2]",
     "from -64 to 63"},
    {"ActiveTooFar", "[2, 58]", "[2, 64]", "site.toml:13:10: 'active' has [2, 64]", "-64 to 63"},
    {"ActiveHalf", "[2, 58]", "[2.5, 58]", "site.toml:13:10: 'active' has [2.5, 58]", "whole"},
    {"Channel",
     "channel = 36",
     "channel = 44",
     "site.toml:10:13: 'centre_hz' is 5190 MHz",
     "channel 44 lies at 5220"},
    {"IdCharacters", "\"ap1\"", "\"ap 1\"", "site.toml:15:6: 'id' is 'ap 1'", "letters, digits"},
    {"PositionOutside",
     "[-1.4, 1.05, 1.2]",
     "[-1.4, 105, 1.2]",
     "site.toml:17:12: 'position' has y = 105 m",
     "[-1.425, 1.425]"},
    {"Core", "core = 2", "core = 4", "site.toml:24:8: 'core' is 4", "from 0 to 3"},
    {"CoreTwice", "core = 0", "core = 2", "site.toml:27:8: core 2 has an antenna already", "one"},
    {"SamePlace",
     "offset = [0, 0, 0]",
     "offset = [0, -0.089, 0]",
     "site.toml:28:10: another antenna",
     "same place"},
    {"OffsetInMillimetres", "-0.089", "-89", "site.toml:25:10: 'offset' is 89 m long", "metres"},
    {"Role", "\"fixed\"", "\"fix\"", "site.toml:34:8: 'fix' is no value of 'role'", "'fixed'"},
    {"Mac", "00:00:01", "00:01", "site.toml:31:7: '02:52:4c:00:01' is not a MAC", "hexadecimal"},
    {"MacTwice", "00:00:02", "00:00:01", "site.toml:35:7: a second transmitter", "once"},
    {"FixedWithoutPosition",
     "position = [1.25, -0.45, 1.2]\n",
     "",
     "site.toml:33:1: [[transmitter]] lacks 'position'",
     "position = ["},
    {"DeviceWithPosition",
     "height_m = 1.1",
     "position = [0, 0, 1]",
     "site.toml:32:12: the 'position' of a device",
     "role = \"fixed\""},
    {"ConstantPower",
     "height_m = 1.1",
     "constant_power = -20",
     "site.toml:32:18: 'constant_power'",
     "true or false"},
    {"FixedWithHeight",
     "position = [1.25, -0.45, 1.2]\n",
     "position = [1.25, -0.45, 1.2]\nheight_m = 1\n",
     "site.toml:37:12: 'height_m' of a fixed",
     "remove it"},
    {"AreaHalf", "area_radius_m = 4.5\n", "", "site.toml:37:1: [person] states one of", "both"},
    {"Permittivity",
     "thickness_m = 0.004",
     "relative_permittivity = 0.5",
     "site.toml:43:25: 'relative_permittivity' is 0.5",
     "from 1"},
    {"Latitude", "49.87", "91", "site.toml:45:12: 'latitude' is 91", "from -90 to 90 degrees"},
    {"TwoCorners",
     "[[0, 0], [1, 0], [1, 1]]",
     "[[0, 0], [1, 0]]",
     "site.toml:50:11: 'polygon' has 2 points",
     "corners"},
    {"Bowtie",
     "[[0, 0], [1, 0], [1, 1]]",
     "[[0, 0], [1, 1], [1, 0], [0, 1]]",
     "site.toml:50:11: 'polygon' crosses itself",
     "outline"},
    {"OneLine",
     "[[0, 0], [1, 0], [1, 1]]",
     "[[0, 0], [1, 1], [2, 2]]",
     "site.toml:50:11: 'polygon' encloses no area",
     "one line"},
    {"Unlisted", "\"ignore\"", "\"ignored\"", "site.toml:52:12: 'ignored' is no value", "'ignore'"},
    {"Control",
     "\"meeting_room\"",
     R"("a\u0007")",
     "site.toml:1:8: 'name' contains a control",
     "one line"},
});

INSTANTIATE_TEST_SUITE_P(All, SiteError, ::testing::ValuesIn(kCases), [](const auto& tested) {
  return std::string(tested.param.name);
});

TEST(SiteErrors, AreAllReportedInOrderOfTheLines) {
  std::string text = site_text("unlisted = \"ignore\"", "unlisted = 3");
  text.replace(text.find("yaw_deg"), 7, "yaw_dog");
  text.replace(text.find("meeting_room"), 12, "meeting/room");
  EXPECT_EQ(errors_of(text),
            "site.toml:1:8: 'name' is part of every topic: write at most 64 bytes, without '/'\n"
            "site.toml:18:1: unknown key 'yaw_dog' in [[access_point]]; did you mean 'yaw_deg'?\n"
            "site.toml:52:12: 'unlisted' is an integer; write text in double quotes: unlisted = "
            "\"...\"");
}

TEST(SiteErrors, SecondAccessPointNeedsItsOwnId) {
  const std::string text = site_text(
      "[[transmitter]]",
      "[[access_point]]\nid = \"ap1\"\nposition = [0, 0, 1]\n[[access_point.antenna]]\ncore = 0\n"
      "offset = [0, 0, 0]\n[[transmitter]]");
  EXPECT_EQ(errors_of(text), "site.toml:30:6: a second access point 'ap1'; give each its own id");
}

TEST(SiteErrors, EmptyFileLacksEverythingItNeeds) {
  const std::string errors = errors_of("");
  for (const char* key : {"'name'", "'scene'", "'carrier'", "'access_point'"}) {
    EXPECT_THAT(errors, HasSubstr(key));
  }
}

}  // namespace
}  // namespace rayloc::site_errors_test
