#include "daemon/lab/trace/trace_link.h"

#include <complex>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "daemon/lab/trace/trace_report.h"
#include "tests/support/scenes.h"

namespace rayloc::trace_link_test {
namespace {

// A closed box beside the line between the antennas.
std::shared_ptr<const Scene> box() {
  return test::make_scene({{"box", test::box_mesh({4, 4, 0.2}, {5, 5, 1.2})},
                           {"floor", test::rectangle_mesh({-9, -9, 0}, {20, 0, 0}, {0, 20, 0})}},
                          test::kConcrete);
}

Link link_between(const Vec3d& tx, const Vec3d& rx) {
  Link link;
  link.transmitter.position = tx;
  link.receiver.position = rx;
  return link;
}

TEST(TraceLink, HasTheChannelOfItsTonesAndTheDerivativesOfItsPower) {
  const auto scene = box();
  LinkTraceOptions options;
  options.trace.max_depth = 1;
  options.tones = OfdmGrid{test::kCarrier, 312'500.0, {-1, 0, 1}};
  options.gradient = *parse_parameters("rx.0,rx_gain", *scene);
  const auto traced = trace_link(scene, link_between({0, 0, 1}, {2, 0, 1}), options);
  ASSERT_TRUE(traced) << traced.error().message;
  EXPECT_FALSE(traced->paths.empty());
  EXPECT_EQ(traced->note, "");
  ASSERT_TRUE(traced->cfr && traced->power);
  ASSERT_EQ(traced->cfr->size(), 3U);
  double power = 0.0;
  for (const std::complex<double>& h : *traced->cfr) {
    power += std::norm(h);
  }
  EXPECT_DOUBLE_EQ(*traced->power, power);
  ASSERT_EQ(traced->gradient.size(), 2U);
  EXPECT_EQ(traced->gradient[0].first, "rx.0");
  // The power is the square of the amplitude factor of an antenna.
  EXPECT_NEAR(traced->gradient[1].second / (2.0 * power), 1.0, 1e-9);
}

TEST(TraceLink, DerivativesAreOfTheCarrierWithoutTones) {
  const auto scene = box();
  LinkTraceOptions options;
  options.trace.max_depth = 0;
  options.gradient = *parse_parameters("rx_gain", *scene);
  const auto traced = trace_link(scene, link_between({0, 0, 1}, {2, 0, 1}), options);
  ASSERT_TRUE(traced) << traced.error().message;
  EXPECT_FALSE(traced->cfr);
  EXPECT_EQ(traced->tones.size(), 1U);
  ASSERT_EQ(traced->paths.size(), 1U);
  EXPECT_NEAR(*traced->power / abs2(traced->paths[0].a), 1.0, 1e-9);
}

TEST(TraceLink, NoPathIsAResultWithANote) {
  const auto scene = box();
  const auto traced = trace_link(scene, link_between({4.5, 4.5, 0.7}, {2, 0, 1}), {});
  ASSERT_TRUE(traced) << traced.error().message;
  EXPECT_TRUE(traced->paths.empty());
  EXPECT_EQ(traced->note, "the transmitter is inside of object 'box'; no path");
  EXPECT_NE(trace_json(*traced, *scene).find("\"note\":\"the transmitter is inside"),
            std::string::npos);
  EXPECT_EQ(trace_table(*traced, *scene).find("0 paths at 5.18 GHz"), 0U);
}

TEST(TraceLink, RefusesDiffuseScatteringWithoutRoughMaterials) {
  LinkTraceOptions options;
  options.trace.diffuse = true;
  EXPECT_FALSE(trace_link(box(), link_between({0, 0, 1}, {2, 0, 1}), options));
}

}  // namespace
}  // namespace rayloc::trace_link_test
