// An edit changes the edited values and leaves all other text of a file as it is.
#include "daemon/live/studio/site_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::site_text_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kText = R"(# Étage 2, measured by Zoë
name = "office"  # the big one
scene = "scene.xml"

[[zone]]  # where the phone lies
name = "desk"
polygon = [[0, 0],
           [1.5, 0],   # the corner with the plant
           [1.5, 1]]
enter_after_s = 0.1

# The one by the door.
[[access_point]]
id = "ap1"
# as surveyed
position = [ 1.0, 2, 2.1 ]  # top of the shelf
yaw_deg = -37
# left to right
[[access_point.antenna]]
core = 2
offset = [0, -0.089, 0]
  [[access_point.antenna]]
  core = 0
  offset = [0, 0, 0]

# The one at the window.
[[access_point]]
id = "ap2"
position = [3, 2, 2.1]
[[access_point.antenna]]
core = 0
offset = [0, 0, 0]

[[transmitter]]
role = "device"
mac = '02:52:4c:00:00:01'

[targets]
height_m = 1.2  # in a pocket)";

class SiteTextTest : public ::testing::Test {
 protected:
  SiteDraft draft_ = read_site_text(kText, "site.toml").value();

  std::string edited() const {
    const auto text = edit_site_text(kText, "site.toml", draft_);
    return text ? *text : "error: " + text.error().message;
  }
  // The text with that for this.
  static std::string with(std::string_view is, std::string_view wanted) {
    std::string text = kText;
    const std::size_t at = text.find(is);
    EXPECT_NE(at, std::string::npos) << is;
    return text.replace(at, is.size(), wanted);
  }
};

TEST_F(SiteTextTest, ReadsEveryElement) {
  ASSERT_EQ(draft_.access_points.size(), 2U);
  EXPECT_EQ(draft_.access_points[0].id, "ap1");
  EXPECT_DOUBLE_EQ(draft_.access_points[0].degrees[0], -37.0);
  EXPECT_EQ(draft_.access_points[0].antennas.size(), 2U);
  ASSERT_EQ(draft_.zones.size(), 1U);
  EXPECT_EQ(draft_.zones[0].polygon.size(), 3U);
  EXPECT_EQ(draft_.devices.at(0).mac, "02:52:4c:00:00:01");
}

TEST_F(SiteTextTest, LeavesEveryByteWhereNothingChanged) { EXPECT_EQ(edited(), kText); }

TEST_F(SiteTextTest, MovesAndRotatesInPlace) {
  draft_.access_points[0].position = {1.25, 2.0, 2.1};
  EXPECT_EQ(edited(), with("[ 1.0, 2, 2.1 ]", "[1.25, 2, 2.1]"));
  draft_.access_points[0].position.x = 1.0;
  draft_.access_points[0].degrees[0] = 90.0;
  EXPECT_EQ(edited(), with("-37", "90"));
}

TEST_F(SiteTextTest, AddsAKeyBehindTheOthersOfItsTable) {
  draft_.access_points[1].degrees[0] = 45.0;
  EXPECT_EQ(edited(), with("position = [3, 2, 2.1]\n", "position = [3, 2, 2.1]\nyaw_deg = 45\n"));
  draft_.access_points[1].degrees[0] = 0.0;
  draft_.devices[0].name = "Zoë's \"phone\"";
  EXPECT_EQ(edited(), with("00:01'\n", "00:01'\nname = \"Zoë's \\\"phone\\\"\"\n"));
}

TEST_F(SiteTextTest, ExchangesCores) {
  draft_.access_points[0].antennas[1].rx_chain = 3;
  EXPECT_EQ(edited(), with("  core = 0", "  core = 3"));
}

TEST_F(SiteTextTest, RenamesAndReshapesAZone) {
  draft_.zones[0].name = "bench";
  EXPECT_EQ(edited(), with("\"desk\"", "\"bench\""));
  draft_.zones[0].polygon = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_THAT(edited(), HasSubstr("polygon = [[0, 0], [1, 0], [1, 1], [0, 1]]\nenter_after_s"));
}

TEST_F(SiteTextTest, TakesOutATableWithItsComments) {
  draft_.access_points.erase(draft_.access_points.begin());
  const std::string text = edited();
  const std::string all = kText;
  const std::size_t begin = all.find("# The one by the door.");
  EXPECT_EQ(text, all.substr(0, begin) + all.substr(all.find("# The one at the window.")));
}

TEST_F(SiteTextTest, AddsTablesBehindThoseOfTheirKind) {
  draft_.zones.push_back({"", "door", {{0, 0}, {1, 0}, {1, 2}}});
  EXPECT_EQ(edited(),
            with("enter_after_s = 0.1\n",
                 "enter_after_s = 0.1\n\n[[zone]]\nname = \"door\"\n"
                 "polygon = [[0, 0], [1, 0], [1, 2]]\n"));
}

TEST_F(SiteTextTest, AddsAnAccessPointWithItsAntennas) {
  draft_.access_points.push_back(
      {"", "ap3", "RT-AX86U", {1, 2, 2}, {30, 0, 0}, {{2, {0, -0.089, 0}}, {0, {0, 0, 0}}}});
  EXPECT_THAT(
      edited(),
      HasSubstr("core = 0\noffset = [0, 0, 0]\n\n[[access_point]]  # RT-AX86U\n"
                "id = \"ap3\"\nposition = [1, 2, 2]\nyaw_deg = 30\n"
                "[[access_point.antenna]]\ncore = 2\noffset = [0, -0.089, 0]\n"
                "[[access_point.antenna]]\ncore = 0\noffset = [0, 0, 0]\n\n[[transmitter]]"));
}

TEST_F(SiteTextTest, KeepsLineEndsOfWindows) {
  const std::string text = "[[zone]]\r\nname = \"a\"\r\npolygon = [[0, 0], [1, 0], [1, 1]]\r\n";
  auto draft = read_site_text(text, "site.toml").value();
  draft.zones[0].name = "b";
  EXPECT_EQ(edit_site_text(text, "site.toml", draft).value(),
            "[[zone]]\r\nname = \"b\"\r\npolygon = [[0, 0], [1, 0], [1, 1]]\r\n");
}

// In braces, values can be changed; nothing can be added or removed.
TEST_F(SiteTextTest, RefusesEditsThatItCannotWriteInPlace) {
  const std::string text = "zone = [{name = \"a\", polygon = [[0, 0], [1, 0], [1, 1]]}]\n";
  auto draft = read_site_text(text, "site.toml").value();
  draft.zones[0].name = "b";
  EXPECT_THAT(edit_site_text(text, "site.toml", draft).value(), HasSubstr("{name = \"b\","));
  draft.zones.clear();
  EXPECT_THAT(edit_site_text(text, "site.toml", draft).error().message, HasSubstr("in braces"));
  draft.zones = {{"a", "a", {{0, 0}, {1, 0}, {1, 1}}}, {"", "c", {{0, 0}, {1, 0}, {1, 1}}}};
  EXPECT_THAT(edit_site_text(text, "site.toml", draft).error().message,
              HasSubstr("cannot be changed here"));
}

TEST_F(SiteTextTest, RefusesNamesThatWouldEndTheLine) {
  draft_.zones[0].name = "a\"\n[carrier]\nchannel = 1 #";
  EXPECT_THAT(edited(), HasSubstr("error: a name has a control character"));
}

TEST_F(SiteTextTest, RefusesADraftThatIsNone) {
  EXPECT_THAT(parse_draft("{").error().message, HasSubstr("no JSON"));
  EXPECT_THAT(parse_draft(R"({"revision": 3})").error().message, HasSubstr("not as the editor"));
}

}  // namespace
}  // namespace rayloc::site_text_test
