#include "engine/person/calibrate/person_fit.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/room/preprocess_burst.h"
#include "tests/support/person_in_room.h"

namespace rayloc::person_fit_test {
namespace {

constexpr double kRadius = 0.178;  // of the person; 0.165 is expected

TargetBody body() {
  TargetBody body = PersonModel{}.body;
  body.semi_axes = {kRadius, kRadius};
  return body;
}

// A person at places that are stated up to 8 mm wrong.
std::vector<PersonPoint> points(const RoomModel& room, std::size_t count) {
  std::vector<PersonPoint> result;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<double>(i);
    const TargetPosition place{1.0 * std::sin(2.4 * t), 0.7 * std::sin(1.7 * t + 0.5)};
    const auto frames =
        test::frames_past(room, {place}, body(), {.count = 6, .seed = static_cast<unsigned>(i)});
    PersonPoint point{{place.x + 0.008 * std::sin(5.0 * t), place.y + 0.008 * std::cos(7.0 * t)},
                      {}};
    std::vector<std::string> warnings;
    for (std::size_t a = 0; a < room.access_points.size(); ++a) {
      point.h.push_back(preprocess_burst(room, a, frames, {}, warnings)->h);
    }
    result.push_back(std::move(point));
  }
  return result;
}

// The transmitter is surveyed a centimetre wrong.
PersonReference displaced(const RoomModel& room) {
  PersonReference reference = test::learn_reference(room);
  const Vec3d off{0.008, -0.006, 0.004};
  reference.transmitter.position = test::fixed_transmitter().position + off;
  return reference;
}

TEST(PersonFit, FindsTheTransmitterAndTheBody) {
  const RoomModel room = test::make_room();
  const auto received = points(room, 20);
  const auto fit = fit_person(room, displaced(room), received);
  ASSERT_TRUE(fit) << fit.error().message;
  const Vec3d off = fit->reference.transmitter.position - test::fixed_transmitter().position;
  EXPECT_LT(std::hypot(off.x, off.y), 0.004) << off.x << " " << off.y;
  EXPECT_NEAR(fit->reference.person.body.semi_axes[0], kRadius, 0.01);
  EXPECT_EQ(fit->points, 20U);
  for (const PersonLink& link : fit->reference.links) {
    EXPECT_NEAR(std::abs(link.scale), 1.0, 0.35);
  }
  EXPECT_LE(fit->reference.person.strength_variance, 0.5);
  EXPECT_EQ(fit->reference.person.front_offset_sigma, 0.0);  // a round body
}

TEST(PersonFit, NeedsEnoughPlaces) {
  const RoomModel room = test::make_room();
  const auto received = points(room, 4);
  const auto fit = fit_person(room, displaced(room), received);
  ASSERT_FALSE(fit);
  EXPECT_NE(fit.error().message.find("4 places"), std::string::npos) << fit.error().message;
}

TEST(PersonFit, ReportsTheLimitsOfTheScale) {
  EXPECT_TRUE(is_scale_at_limit(std::polar(1.804, 2.0)));
  EXPECT_FALSE(is_scale_at_limit(std::polar(1.699, 2.0)));
  EXPECT_FALSE(is_scale_at_limit(-0.85));
  EXPECT_FALSE(is_scale_at_limit(0.377));
  EXPECT_TRUE(is_scale_at_limit(0.355));
}

}  // namespace
}  // namespace rayloc::person_fit_test
