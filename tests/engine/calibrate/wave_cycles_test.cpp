// Walls half a wave off, to which the rest of the room has come to terms.
#include "engine/calibrate/joint/wave_cycles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/base/constants.h"
#include "engine/scene/scene.h"
#include "tests/support/surveyed_room.h"

namespace rayloc::wave_cycles_test {
namespace {

class WaveCyclesTest : public ::testing::Test {
 protected:
  WaveCyclesTest() {
    std::vector<SampleSite> sites;
    for (std::size_t p = 0; p < room_.points.size(); ++p) {
      sites.push_back({p, 0, room_.points[p].position});
    }
    traced_ = trace_samples(room_.plan, unknowns_, sites, {.max_depth = 2}).value();
    truth_.values.resize(unknowns_.size());
    truth_.survey.resize(room_.points.size());
    for (std::uint32_t i = 0; i < unknowns_.size(); ++i) {
      const auto known = room_.truth.find(to_string(parameter_id(unknowns_[i], room_.plan)));
      if (known != room_.truth.end() && !is_material(unknowns_[i].kind)) {
        truth_.values[i] = known->second;
      }
    }
    for (std::size_t p = 0; p < room_.points.size(); ++p) {
      measured_.push_back(
          model_.measured(traced_[p], {truth_.values, Vec3d{}}, room_.points[p].h[0]));
    }
    for (std::size_t p = 0; p < room_.points.size(); ++p) {
      samples_.push_back({&traced_[p], &measured_[p]});
    }
    for (std::uint32_t i = 0; i < unknowns_.size(); ++i) {
      released_[i] = is_material(unknowns_[i].kind) ? 0 : 1;
    }
  }

  static bool is_material(Unknown::Kind kind) {
    return kind == Unknown::Kind::kPermittivity || kind == Unknown::Kind::kConductivity ||
           kind == Unknown::Kind::kThickness;
  }

  std::uint32_t offset_of(const std::string& wall) const {
    for (std::uint32_t i = 0; i < unknowns_.size(); ++i) {
      if (to_string(parameter_id(unknowns_[i], room_.plan)) == wall + ".offset") {
        return i;
      }
    }
    ADD_FAILURE() << wall;
    return 0;
  }

  JointContext context() const { return {model_, unknowns_, samples_, zero_}; }
  JointOptions options(int iterations) const { return {0.05, iterations, 0.005, released_}; }

  // Half a wave off, everything else fitted to that.
  JointState settled_wrongly(const std::vector<std::pair<std::string, double>>& walls) const {
    JointState state = truth_;
    for (const auto& [wall, side] : walls) {
      state.values[offset_of(wall)] += side * half_wave_;
    }
    JointProblem(context()).solve(options(5), state, {});
    return state;
  }

  WaveCycles settle(JointState& state, std::function<bool()> go_on = {}) const {
    std::vector<std::uint32_t> surfaces;
    for (const char* wall : {"west.+x", "east.-x", "south.+y", "north.-y"}) {
      surfaces.push_back(unknowns_[offset_of(wall)].index);
    }
    return settle_wave_cycles(
        context(), {surfaces, half_wave_, options(5), std::move(go_on)}, state);
  }

  double off(const JointState& state, const std::string& wall) const {
    return std::abs(state.values[offset_of(wall)] - truth_.values[offset_of(wall)]);
  }

  test::SurveyedRoom room_ = test::make_surveyed_room({.points = 40, .trace = {.max_depth = 2}});
  RoomUnknowns unknowns_{room_.plan, {}};
  SampleModel model_{room_.plan.grid};
  std::vector<double> zero_ = std::vector<double>(unknowns_.size());
  std::vector<char> released_ = std::vector<char>(unknowns_.size());
  std::vector<TracedSample> traced_;
  std::vector<MeasuredSample> measured_;
  std::vector<JointSample> samples_;
  JointState truth_;
  double half_wave_ = 0.5 * kSpeedOfLight / room_.plan.grid.centre_hz;
};

TEST_F(WaveCyclesTest, KeepsARoomThatIsRight) {
  JointState state = truth_;
  JointProblem(context()).solve(options(10), state, {});
  settle(state);
  for (const char* wall : {"west.+x", "east.-x", "south.+y", "north.-y"}) {
    EXPECT_LT(off(state, wall), 0.005) << wall;
  }
}

TEST_F(WaveCyclesTest, BringsOneWallBack) {
  JointState state = settled_wrongly({{"west.+x", 1.0}});
  ASSERT_GT(off(state, "west.+x"), 0.02);
  EXPECT_TRUE(settle(state).moved);
  EXPECT_LT(off(state, "west.+x"), 0.005);
}

TEST_F(WaveCyclesTest, BringsTwoWallsBack) {
  JointState state = settled_wrongly({{"south.+y", -1.0}, {"west.+x", -1.0}});
  ASSERT_GT(off(state, "south.+y"), 0.02);
  ASSERT_GT(off(state, "west.+x"), 0.02);
  EXPECT_TRUE(settle(state).moved);
  EXPECT_LT(off(state, "south.+y"), 0.005);
  EXPECT_LT(off(state, "west.+x"), 0.005);
}

TEST_F(WaveCyclesTest, ListsAlternativeCyclesOfEachSurface) {
  JointState state = settled_wrongly({});
  const WaveCycles cycles = settle(state);
  EXPECT_EQ(cycles.others.size(), 8U);  // four walls, to either side
  std::vector<double> sigma(unknowns_.size());
  const std::vector<WaveCycle> as_good{{0, state.values[0] + half_wave_, 0.0}};
  widen_by_wave_cycles(as_good, unknowns_, state, sigma);
  EXPECT_NEAR(sigma[0], half_wave_ * std::sqrt(0.5), 1e-12);
}

TEST_F(WaveCyclesTest, StopsOnRequest) {
  JointState state = settled_wrongly({{"west.+x", 1.0}});
  int asked = 0;
  settle(state, [&] { return ++asked < 3; });
  EXPECT_EQ(asked, 3);
}

}  // namespace
}  // namespace rayloc::wave_cycles_test
