#include "daemon/lab/simulate/channel_draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/constants.h"
#include "engine/room/ray.h"
#include "engine/trace/radio_device.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

// Echoes of the tail: far closer than 160 MHz can resolve, until e^-10 is left.
constexpr double kTailStep = 1e-9;  // [s]
constexpr double kTailDecays = 10.0;

// Adds a unit wave times `factor` that arrives after `delay` [s].
void add_wave(Value factor, double delay, const OfdmGrid& grid, Value* row) {
  for (std::size_t k = 0; k < grid.size(); ++k) {
    row[k] += factor * std::polar(1.0, -2.0 * std::numbers::pi * grid.frequency_hz(k) * delay);
  }
}

}  // namespace

ChannelDraw::ChannelDraw(const RoomModel& room, std::size_t access_point, RandomStream random)
    : room_(room),
      error_(room.access_points.at(access_point).error),
      offsets_(offsets_of(room.access_points[access_point].array)),
      tracer_(PathTracer(room.scene, room.trace)
                  .at(array_origin<Receiver>(room.access_points[access_point].array))),
      model_(room.grid, offsets_.size()),
      random_(random) {}

Value ChannelDraw::normal() {
  const double re = normal_(random_);
  return Value(re, normal_(random_)) / std::numbers::sqrt2;
}

void ChannelDraw::add_tail(double power, double first, const OfdmGrid& grid, Value* row) {
  const double share = 1.0 - std::exp(-kTailStep / error_.diffuse_decay);
  for (double after = 0.0; after < kTailDecays * error_.diffuse_decay; after += kTailStep) {
    const double part = power * share * std::exp(-after / error_.diffuse_decay);
    add_wave(std::sqrt(part) * normal(), first + after, grid, row);
  }
}

ChannelDraw::Channel ChannelDraw::at(const Pose& pose, const OfdmGrid& grid) {
  const Transmitter device{
      {pose.position, pose.orientation, room_.device.pattern, room_.device.polarization}};
  const std::vector<Ray> rays = rays_of(tracer_.trace(device), room_, pose.position, kMaxRays);
  const std::size_t tones = grid.size();
  Channel channel{std::vector<Value>(offsets_.size() * tones), rays.size()};
  if (rays.empty()) {
    return channel;
  }
  const ObservationModel::RayTerms terms = model_.ray_terms({rays, offsets_, 0.0}, error_);
  double power = 0.0;
  for (std::size_t p = 0; p < rays.size(); ++p) {
    const Ray& ray = rays[p];
    power += std::norm(ray.amplitude);
    // E[e^{j x}] = e^{-sigma^2 / 2} is the known fraction of the ray in the likelihood.
    const auto [known, unknown] = terms.parts[p];
    const double turn = std::sqrt(-2.0 * std::log(known)) * normal_(random_);
    const double strength = std::max(0.0, unknown - 1.0 + known * known);
    const Value amplitude =
        ray.amplitude * (std::polar(1.0, turn) + std::sqrt(strength) * normal());
    for (std::size_t m = 0; m < offsets_.size(); ++m) {
      const double length = norm(ray.length * ray.at_array - offsets_[m]);
      add_wave(amplitude, length / kSpeedOfLight, grid, channel.h.data() + m * tones);
    }
  }
  const double diffuse = power * diffuse_share(error_, terms.first_length);
  // The rest is a share of the subspace of possible room echoes, of model_.dimension() coordinates.
  const double rest =
      std::sqrt(power * error_.noise * static_cast<double>(room_.grid.size() * offsets_.size()) /
                static_cast<double>(model_.dimension()));
  for (std::size_t m = 0; m < offsets_.size(); ++m) {
    Value* const row = channel.h.data() + m * tones;
    if (diffuse > 0.0) {
      add_tail(diffuse, terms.first_length / kSpeedOfLight, grid, row);
    }
    for (std::size_t k = 0; k < tones; ++k) {
      row[k] += rest * normal();
    }
  }
  return channel;
}

}  // namespace rayloc
