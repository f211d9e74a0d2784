#include "daemon/lab/predict/predict_site.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/test_paths.h"

namespace rayloc::predict_site_test {
namespace {

Site meeting_room() { return *load_site(test::data_path("/sites/meeting_room")); }

TEST(PredictSite, DividesTheFramesAmongTheDevices) {
  SitePredictionOptions options;
  options.rate = 50.0;
  options.burst = 0.2;
  EXPECT_DOUBLE_EQ(options.frames_per_burst(), 10.0);
  options.devices = 20;
  EXPECT_DOUBLE_EQ(options.frames_per_burst(), 0.5);
}

TEST(PredictSite, RefusesABandwidthThatNoFrameHas) {
  SitePredictionOptions options;
  options.plan.bandwidth_mhz = 30;
  EXPECT_FALSE(check_prediction(options));
  const auto refused = predict_site(meeting_room(), options, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  EXPECT_NE(refused.error().message.find("--bandwidth"), std::string::npos);
}

TEST(PredictSite, PredictsWithTheFramesOfOneDeviceAndReportsItsProgress) {
  SitePredictionOptions options;
  options.plan.access_points = {"ap1"};
  options.prediction.draws = 1;
  options.step = 1.5;
  options.devices = 20;
  std::vector<double> shares;
  Observer observer;
  observer.on_progress = [&](double share, const std::string& stage) {
    EXPECT_EQ(stage, "predicting");
    shares.push_back(share);
  };
  const auto predicted = predict_site(meeting_room(), options, observer);
  ASSERT_TRUE(predicted) << predicted.error().message;
  EXPECT_EQ(predicted->options.frames, 1U);
  EXPECT_EQ(predicted->options.bandwidth_mhz, 40);
  EXPECT_DOUBLE_EQ(predicted->received_share, 0.5);
  EXPECT_EQ(predicted->prediction.places.size(), predicted->places.size());
  ASSERT_FALSE(shares.empty());
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_EQ(shares.back(), 1.0);
}

}  // namespace
}  // namespace rayloc::predict_site_test
