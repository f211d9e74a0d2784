#include "engine/likelihood/point_arrays.h"

#include <cmath>

namespace rayloc {
namespace {

double power(const std::vector<std::complex<double>>& h) {
  double sum = 0.0;
  for (const std::complex<double>& value : h) {
    sum += std::norm(value);
  }
  return sum;
}

}  // namespace

PointArrays::PointArrays(const RoomModel& room, std::size_t access_point)
    : room_(room),
      aligner_(room.grid),
      access_point_(room.access_points.at(access_point)),
      model_(room.grid, access_point_.rx_chains.size()),
      tracer_(PathTracer(room.scene, room.trace).at(array_origin<Receiver>(access_point_.array))) {}

std::vector<Ray> PointArrays::rays(const Vec3d& position, const DeviceModel& device) const {
  const Transmitter transmitter{{position, {}, device.pattern, device.polarization}};
  return rays_of(tracer_.trace(transmitter), room_, position, kMaxRays);
}

std::vector<std::complex<double>> PointArrays::expected(const std::vector<Ray>& rays,
                                                        double plan_tolerance,
                                                        const ArrayMotion& motion) const {
  AntennaArray array = access_point_.array;
  array.pose.orientation.yaw += motion.yaw;
  std::vector<Vec3d> offsets;
  for (std::size_t i = 0; i < array.element_offset.size(); ++i) {
    offsets.push_back(element_position(array, i) - array.pose.position + motion.shift);
  }
  ModelError error = access_point_.error;
  error.plan_tolerance = plan_tolerance;
  return model_.expected({rays, offsets, 0.0}, error);
}

double PointArrays::known_share(const std::vector<Ray>& rays, double plan_tolerance) const {
  double known = 0.0;
  double whole = 0.0;
  for (const Ray& ray : rays) {
    known += power(expected({ray}, plan_tolerance));
    whole += power(expected({ray}, 0.0));
  }
  return whole > 0.0 ? known / whole : 0.0;
}

std::vector<double> PointArrays::place_phase_sigma(const Vec3d& position,
                                                   const DeviceModel& device,
                                                   double plan_tolerance,
                                                   double place_sigma) const {
  const std::size_t tones = room_.grid.size();
  const auto here = expected(rays(position, device), plan_tolerance);
  std::vector<double> sigma(access_point_.rx_chains.size());
  for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
    auto there = expected(rays(position + place_sigma * axis, device), plan_tolerance);
    aligner_.apply(aligner_.align(here, there), there);
    std::vector<std::complex<double>> turn(sigma.size());
    for (std::size_t j = 0; j < here.size(); ++j) {
      turn[j / tones] += there[j] * std::conj(here[j]);
    }
    for (std::size_t m = 1; m < sigma.size(); ++m) {
      sigma[m] = std::hypot(sigma[m], std::arg(turn[m] * std::conj(turn[0])));
    }
  }
  return sigma;
}

}  // namespace rayloc
