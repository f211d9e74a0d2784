#include "daemon/lab/simulate/handling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string_view>

#include "daemon/lab/simulate/random_stream.h"
#include "daemon/lab/simulate/rotations.h"
#include "daemon/lab/simulate/solid_objects.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

constexpr double kHandTime = 2.0;    // [s], correlation time of a moving hand
constexpr std::size_t kWaves = 32;   // in a smooth random function: enough to be normal
constexpr int kMaxRedraws = 10'000;  // for a height that is not free

// A random function of time with normal values of unit
// variance, correlated by exp(-(t / kHandTime)^2 / 2).
class SmoothNormal {
 public:
  explicit SmoothNormal(RandomStream random) {
    std::normal_distribution<double> rate(0.0, 1.0 / kHandTime);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    for (Wave& wave : waves_) {
      wave.rate = rate(random);
      wave.phase = phase(random);
    }
  }
  double at(double seconds) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) {
      sum += std::cos(wave.rate * seconds + wave.phase);
    }
    return std::sqrt(2.0 / kWaves) * sum;
  }

 private:
  struct Wave {
    double rate = 0.0;   // [rad/s]
    double phase = 0.0;  // [rad]
  };
  std::array<Wave, kWaves> waves_;
};

// Draws one normal number for every test point.
std::vector<double> draw(const std::vector<SimulatedPoint>& test_points,
                         bool is_walk,
                         std::uint64_t seed,
                         std::string_view purpose) {
  std::vector<double> values;
  values.reserve(test_points.size());
  if (is_walk) {
    const SmoothNormal function(random_stream(seed, purpose));
    for (const SimulatedPoint& test_point : test_points) {
      const Duration since =
          test_point.frames.front().time - test_points.front().frames.front().time;
      values.push_back(function.at(to_seconds(since)));
    }
    return values;
  }
  for (std::size_t i = 0; i < test_points.size(); ++i) {
    RandomStream random = random_stream(seed, purpose, i);
    values.push_back(std::normal_distribution<double>()(random));
  }
  return values;
}

struct Heights {
  double lower = 0.0;
  double upper = 0.0;

  explicit Heights(const RoomModel& room) {
    const double margin = std::min(kHeightMargin, 0.25 * (room.bounds_max.z - room.bounds_min.z));
    lower = room.bounds_min.z + margin;
    upper = room.bounds_max.z - margin;
  }
  bool contain(double height) const { return lower <= height && height <= upper; }
  // Reflects a height at the bounds.
  double reflected(double height) const {
    const double range = upper - lower;
    return lower + std::abs(std::remainder(height - lower, 2.0 * range));
  }
};

Expected<void> raise(std::vector<SimulatedPoint>& test_points,
                     bool is_walk,
                     const Handling& handling,
                     const RoomModel& room,
                     std::uint64_t seed) {
  const Heights heights(room);
  const double mean = room.device.height;
  if (!heights.contain(mean)) {
    return bad_input("the height of devices, " + std::to_string(mean) +
                     " m, is not inside of the room; correct height_m of the site");
  }
  if (is_walk) {
    const std::vector<double> normals = draw(test_points, true, seed, "height");
    for (std::size_t i = 0; i < test_points.size(); ++i) {
      test_points[i].position.z = heights.reflected(mean + handling.height_sigma * normals[i]);
    }
    return {};
  }
  const SolidObjects objects(room);
  for (std::size_t i = 0; i < test_points.size(); ++i) {
    RandomStream random = random_stream(seed, "height", i);
    std::normal_distribution<double> normal(mean, handling.height_sigma);
    Vec3d& place = test_points[i].position;
    bool found = false;
    for (int n = 0; n < kMaxRedraws && !found; ++n) {
      place.z = normal(random);
      found = heights.contain(place.z) && !objects.contain(place);
    }
    if (!found) {
      return bad_input("line " + std::to_string(test_points[i].line) + ": no height of " +
                       std::to_string(mean) + " +- " + std::to_string(handling.height_sigma) +
                       " m is outside of the objects there; move the point");
    }
  }
  return {};
}

// Upright, tilted to any side. `a` and `b` are normal: the angle
// is uniform from 0 to `most`, the side uniform all around.
Orientation tilted(double a, double b, double most) {
  const double angle = most * (1.0 - std::exp(-0.5 * (a * a + b * b)));
  const double towards = std::atan2(b, a);
  return orientation_of(rotation_about({-std::sin(towards), std::cos(towards), 0.0}, angle));
}

}  // namespace

Expected<void> handle_devices(std::vector<SimulatedPoint>& test_points,
                              bool is_walk,
                              const Handling& handling,
                              const RoomModel& room,
                              std::uint64_t seed,
                              const std::string& file) {
  if (test_points.empty()) {
    return {};
  }
  if (handling.height_sigma > 0.0) {
    if (auto raised = raise(test_points, is_walk, handling, room, seed); !raised) {
      return bad_input(file + ": " + raised.error().message);
    }
  }
  if (handling.tilt_deg > 0.0) {
    const std::vector<double> a = draw(test_points, is_walk, seed, "tilt a");
    const std::vector<double> b = draw(test_points, is_walk, seed, "tilt b");
    for (std::size_t i = 0; i < test_points.size(); ++i) {
      test_points[i].orientation = tilted(a[i], b[i], kDegree * handling.tilt_deg);
    }
  }
  if (handling.power_sigma_db > 0.0) {
    const std::vector<double> normals = draw(test_points, is_walk, seed, "power");
    for (std::size_t i = 0; i < test_points.size(); ++i) {
      test_points[i].power_db = handling.power_sigma_db * normals[i];
    }
  }
  return {};
}

}  // namespace rayloc
