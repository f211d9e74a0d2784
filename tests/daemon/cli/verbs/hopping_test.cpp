// A device that hops over radio channels: simulated, and located by the method that uses them.
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/closet_plan.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/verb_folder.h"

namespace rayloc::hopping_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Half a second at each of columns x rows places.
std::string points(int columns, int rows, double shift, int start) {
  std::string text = "t_start,t_end,x,y,z\n";
  for (int i = 0; i < columns * rows; ++i) {
    const double x = -1.0 + 2.0 / columns * (i % columns) + shift;
    const int row = i / columns;
    const double y = -0.7 + 1.5 / rows * row + shift;
    const int t = start + 2 * i;
    text += std::to_string(t) + "," + std::to_string(t) + ".5," + std::to_string(x) + "," +
            std::to_string(y) + ",1.2\n";
  }
  return text;
}

std::vector<json> lines_of(const std::string& text) {
  std::vector<json> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    all.push_back(json::parse(line));
  }
  return all;
}

class Hopping : public test::VerbFolder {
 protected:
  Hopping() : VerbFolder("hopping_" + test_name()) {}

  void SetUp() override {
    write("plan.toml", test::closet_plan());
    run({"scene", "room", path("plan.toml"), "--out", path("site"), "--quiet"});
  }
  Finished simulate(const std::string& site,
                    const std::string& points_file,
                    const std::string& name,
                    const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        "simulate", path(site), "--points", points_file, "--out", "ap1=" + path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RaylocProcess(arguments).wait();
  }
};

TEST_F(Hopping, ARecordingThatHopsIsLocatedByTheMethodThatUsesItsChannels) {
  const auto survey = write("survey.csv", points(5, 4, 0.0, 1000));
  ASSERT_EQ(simulate("site", survey, "survey.pcap", {}).status, 0);
  run({"calibrate",
       path("site"),
       "--gains-only",
       "--quiet",
       "--points",
       survey,
       "--out",
       path("calibrated"),
       "--capture",
       "ap1=" + path("survey.pcap")});
  const auto truth = write("truth.csv", points(2, 2, 0.3, 5000));
  // 40 MHz: four channels, five frames of each at each of four points, three datagrams a frame.
  const Finished simulated = simulate("calibrated",
                                      truth,
                                      "hops.pcap",
                                      {"--channels",
                                       "36-64",
                                       "--frames",
                                       "20",
                                       "--impairments",
                                       write("radio.toml", "retry_share = 0\n")});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  std::vector<double> centres;
  const json report = json::parse(simulated.out);
  for (const auto& channel : report.at("channels")) {
    centres.push_back(channel["centre_hz"]);
    EXPECT_EQ(channel["bandwidth_mhz"], 40);
  }
  EXPECT_THAT(centres, ElementsAre(5190e6, 5230e6, 5270e6, 5310e6));

  const auto replay = [&](const std::string& method) {
    return RaylocProcess({"replay",
                          path("calibrated"),
                          "ap1=" + path("hops.pcap"),
                          "--method",
                          method,
                          "--kind",
                          "device",
                          "--burst",
                          "0.6s",
                          "--no-cache"})
        .wait();
  };
  const Finished hopping = replay("m3");
  ASSERT_EQ(hopping.status, 0) << hopping.err;
  EXPECT_THAT(hopping.err, HasSubstr("240 packets, 0 rejected, 80 frames"));
  EXPECT_THAT(hopping.err, HasSubstr("packets of 4 channels are used: 60 of 5190 MHz"));
  EXPECT_THAT(hopping.err, Not(HasSubstr("the channel changed")));
  const auto estimates = lines_of(hopping.out);
  ASSERT_EQ(estimates.size(), 4U);
  for (const json& estimate : estimates) {
    EXPECT_TRUE(estimate.contains("position")) << estimate;
    EXPECT_EQ(estimate["quality"]["frames"], 20) << estimate;
    EXPECT_THAT(estimate["quality"]["warnings"].get<std::vector<std::string>>(),
                Contains(HasSubstr("hops over 4 channels")));
  }
  // Others locate by the site's channel.
  const Finished others = replay("rayloc");
  ASSERT_EQ(others.status, 0) << others.err;
  EXPECT_THAT(others.err, HasSubstr("240 packets, 180 rejected, 20 frames"));
  EXPECT_THAT(others.err, HasSubstr("other_channel"));
  EXPECT_THAT(others.err, HasSubstr("the channel changed"));
}

TEST_F(Hopping, SimulateRefusesChannelsThatThereAreNot) {
  const auto file = write("points.csv", points(2, 1, 0.0, 100));
  for (const auto& [channels, words] : {std::pair{"36-", "36-64,100-144"},
                                        std::pair{"70", "no channel of 40 MHz"},
                                        std::pair{"36-177", "--frames 10"}}) {
    const Finished finished = simulate("site", file, "a.pcap", {"--channels", channels});
    EXPECT_EQ(finished.status, 64) << channels;
    EXPECT_THAT(finished.err, HasSubstr("--channels"));
    EXPECT_THAT(finished.err, HasSubstr(words));
  }
}

}  // namespace
}  // namespace rayloc::hopping_test
