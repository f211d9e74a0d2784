#include "engine/person/calibrate/empty_room.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/likelihood/point_arrays.h"
#include "engine/observe/alignment.h"
#include "engine/person/calibrate/offset_cube.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

// Floor of the missing squared correlation: diffuse power that no traced room explains.
constexpr double kFloor = 0.03;
constexpr double kReach = 2.5;  // places within this many standard deviations are tried
constexpr int kSteps = 4;       // on each side of the surveyed place, along an axis

double power(const std::vector<Value>& h) {
  double sum = 0.0;
  for (const Value& v : h) {
    sum += std::norm(v);
  }
  return sum;
}

double first_length(const std::vector<Ray>& rays) {
  double first = rays.front().length;
  for (const Ray& ray : rays) {
    first = std::min(first, ray.length);
  }
  return first;
}

class EmptyRoomFit {
 public:
  EmptyRoomFit(const RoomModel& room,
               const Transmitter& surveyed,
               std::span<const EmptyRoom> received)
      : room_(room),
        surveyed_(surveyed),
        device_{surveyed.position.z, 0.0, surveyed.pattern, surveyed.polarization},
        received_(received),
        aligner_(room.grid) {
    for (const EmptyRoom& one : received) {
      arrays_.emplace_back(room, one.access_point);
    }
  }

  // [rx_chain][tone], absolute; empty where no ray arrives. `tolerance` [m]: PointArrays::expected.
  std::vector<Value> expected(std::size_t i, const Vec3d& place, double tolerance) const {
    const auto rays = arrays_[i].rays(place, device_);
    if (rays.empty()) {
      return {};
    }
    auto h = arrays_[i].expected(rays, tolerance);
    const double delay = first_length(rays) / kSpeedOfLight;
    for (std::size_t j = 0; j < h.size(); ++j) {
      const double f = room_.grid.frequency_hz(j % room_.grid.size());
      h[j] *= std::polar(1.0, -2.0 * std::numbers::pi * f * delay);
    }
    return h;
  }

  Alignment align(std::size_t i, const Vec3d& place) const {
    const auto traced =
        expected(i, place, room_.access_points[received_[i].access_point].error.plan_tolerance);
    return traced.empty() ? Alignment{} : aligner_.align(traced, received_[i].h);
  }

  // Twice the negative log-likelihood, up to a constant.
  double cost(const Vec3d& place, double sigma) const {
    const Vec3d off = place - surveyed_.position;
    double sum = dot(off, off) / (sigma * sigma);
    for (std::size_t i = 0; i < received_.size(); ++i) {
      // The array has as many informative numbers on the place as antennas.
      const std::size_t numbers = received_[i].h.size() / room_.grid.size();
      sum +=
          2.0 * static_cast<double>(numbers) * std::log(kFloor + 1.0 - align(i, place).correlation);
    }
    return sum;
  }

  Vec3d best_place(double sigma) const {
    const OffsetCube cube(kSteps);
    std::vector<double> costs(cube.size());
    const double step = kReach * sigma / kSteps;
    const auto place = [&](std::size_t n) { return surveyed_.position + step * cube[n]; };
    parallel_for(costs.size(), 4, [&](std::size_t n) { costs[n] = cost(place(n), sigma); });
    return place(
        static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin()));
  }

  // Scaled to the power of the traced room: least squares would treat power that the trace does not
  // explain as a loss.
  PersonLink link(std::size_t i, const Vec3d& place) const {
    PersonLink result{received_[i].access_point, received_[i].h, 1.0, 0.0};
    Alignment alignment = align(i, place);
    result.room_fit = alignment.correlation;
    const auto traced = expected(i, place, 0.0);
    if (!traced.empty() && alignment.correlation > 0.0) {
      alignment.factor *=
          std::sqrt(power(traced) / power(received_[i].h)) / std::abs(alignment.factor);
      aligner_.apply(alignment, result.empty);
    }
    return result;
  }

 private:
  const RoomModel& room_;
  const Transmitter& surveyed_;
  DeviceModel device_;
  std::span<const EmptyRoom> received_;
  Aligner aligner_;
  std::vector<PointArrays> arrays_;
};

}  // namespace

Expected<PersonReference> fit_empty_room(const RoomModel& room,
                                         const Transmitter& surveyed,
                                         std::span<const EmptyRoom> received,
                                         const EmptyRoomOptions& options) {
  RAYLOC_CHECK(!received.empty());
  const EmptyRoomFit fit(room, surveyed, received);
  PersonReference reference;
  reference.transmitter = surveyed;
  reference.transmitter.position = fit.best_place(options.place_sigma);
  for (std::size_t i = 0; i < received.size(); ++i) {
    PersonLink link = fit.link(i, reference.transmitter.position);
    if (!(link.room_fit > 0.0)) {
      return bad_input("access point " + room.access_points[received[i].access_point].id +
                       ": no path of the room leads to it from the fixed transmitter; is the "
                       "transmitter's position in site.toml right?");
    }
    reference.links.push_back(std::move(link));
  }
  return reference;
}

}  // namespace rayloc
