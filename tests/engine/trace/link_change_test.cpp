// change_link against a scene and devices that are changed by hand (traced_link.h).
#include "engine/trace/link_change.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "engine/trace/path_tracer.h"
#include "tests/support/traced_link.h"

namespace rayloc::link_change_test {
namespace {

using test::TracedLink;

ChangedLink of(const TracedLink& link) {
  return {link.shared_scene(), link.transmitters().front(), link.receivers().front(), 1.0};
}

std::vector<std::complex<double>> channel(const ChangedLink& link, const TracedLink& like) {
  const PathTracer tracer(link.scene, like.options());
  auto h = tracer.trace(link.transmitter, link.receiver).cfr(like.grid());
  for (auto& value : h) {
    value *= link.gain;
  }
  return h;
}

TEST(LinkChange, IsThatOfEveryParameter) {
  const TracedLink link = TracedLink::of("box", {.max_depth = 2});
  const auto unchanged = channel(of(link), link);
  int noticed = 0;
  for (const Parameter& parameter : link.parameters()) {
    const double by = 50.0 * test::difference_step(parameter);
    const auto changed = change_link(of(link), std::array{parameter}, std::array{by});
    ASSERT_TRUE(changed) << changed.error().message;
    const auto h = channel(*changed, link);
    const test::Csi expected = link.changed(parameter, by).csi();
    double largest = 0.0;
    for (const auto& tone : h) {
      largest = std::max(largest, std::abs(tone));
    }
    for (std::size_t j = 0; j < h.size(); ++j) {
      EXPECT_LE(std::abs(h[j] - expected[j]), 1e-9 * largest) << link.name_of(parameter);
    }
    noticed += h == unchanged ? 0 : 1;
  }
  // All but walls that slide along themselves, and the screen that no path meets.
  EXPECT_GT(noticed, 20);
}

TEST(LinkChange, LeavesTheSceneWhereOnlyEndsChange) {
  const TracedLink link = TracedLink::of("box", {.max_depth = 1});
  const auto changed =
      change_link(of(link),
                  std::array{Parameter::receiver_position(0), Parameter::receiver_position(0)},
                  std::array{0.1, 0.2});
  ASSERT_TRUE(changed);
  EXPECT_EQ(changed->scene, link.shared_scene());
  EXPECT_NEAR(changed->receiver.position.x, link.receivers().front().position.x + 0.3, 1e-12);
}

TEST(LinkChange, RefusesInvalidChanges) {
  const TracedLink link = TracedLink::of("box", {.max_depth = 1});
  const auto refused = [&](const Parameter& parameter, double by) {
    const auto changed = change_link(of(link), std::array{parameter}, std::array{by});
    return changed ? std::string() : changed.error().message;
  };
  EXPECT_NE(refused(Parameter::relative_permittivity(99), 0.1), "");
  EXPECT_NE(refused(Parameter::receiver_position(0), std::numeric_limits<double>::quiet_NaN()), "");
  EXPECT_NE(refused(Parameter::relative_permittivity(0), -100.0), "");  // below that of vacuum
}

}  // namespace
}  // namespace rayloc::link_change_test
