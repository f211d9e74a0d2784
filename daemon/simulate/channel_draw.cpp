#include "daemon/simulate/channel_draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/constants.h"
#include "engine/localize/ray.h"
#include "engine/trace/radio_device.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

// Echoes of the tail: far closer than 160 MHz can tell, and until e^-10 is left.
constexpr double kTailStep = 1e-9;  // [s]
constexpr double kTailDecays = 10.0;

// Adds a unit wave times `factor` that arrives after `delay` [s].
void add_wave(Value factor, double delay, const OfdmGrid& grid, Value* row) {
  for (std::size_t k = 0; k < grid.size(); ++k) {
    row[k] += factor * std::polar(1.0, -2.0 * std::numbers::pi * grid.frequency_hz(k) * delay);
  }
}

double first_length(const std::vector<Ray>& rays) {
  return std::min_element(rays.begin(),
                          rays.end(),
                          [](const Ray& a, const Ray& b) { return a.length < b.length; })
      ->length;
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

std::vector<Value> ChannelDraw::tail(const OfdmGrid& grid) {
  std::vector<Value> row(grid.size());
  const double share = 1.0 - std::exp(-kTailStep / error_.diffuse_decay);
  for (double delay = 0.0; delay < kTailDecays * error_.diffuse_decay; delay += kTailStep) {
    const double power = share * std::exp(-delay / error_.diffuse_decay);
    add_wave(std::sqrt(power) * normal(), delay, grid, row.data());
  }
  return row;
}

ChannelDraw::Channel ChannelDraw::at(const Vec3d& position, const OfdmGrid& grid) {
  const Transmitter device{{position, {}, room_.device.pattern, room_.device.polarization}};
  const std::vector<Ray> rays = rays_of(tracer_.trace(device), room_, position, kMostRays);
  const std::size_t tones = grid.size();
  Channel channel{std::vector<Value>(offsets_.size() * tones), rays.size()};
  if (rays.empty()) {
    return channel;
  }
  const auto parts = model_.ray_terms({rays, offsets_, 0.0}, error_).parts;
  double power = 0.0;
  for (std::size_t p = 0; p < rays.size(); ++p) {
    const Ray& ray = rays[p];
    power += std::norm(ray.amplitude);
    // E[e^{j x}] = e^{-sigma^2 / 2} is what the likelihood knows of the ray.
    const double turn = std::sqrt(-2.0 * std::log(parts[p].known)) * normal_(random_);
    const double strength = std::max(0.0, parts[p].unknown - 1.0 + parts[p].known * parts[p].known);
    const Value amplitude =
        ray.amplitude * (std::polar(1.0, turn) + std::sqrt(strength) * normal());
    for (std::size_t m = 0; m < offsets_.size(); ++m) {
      const double length = norm(ray.length * ray.at_array - offsets_[m]);
      add_wave(amplitude, length / kSpeedOfLight, grid, channel.h.data() + m * tones);
    }
  }
  const double first = first_length(rays);
  const double diffuse = std::sqrt(power * diffuse_share(error_, first));
  // The rest is a share of what the echoes of a room can be: of model_.dimension() coordinates.
  const double rest =
      std::sqrt(power * error_.noise * static_cast<double>(room_.grid.size() * offsets_.size()) /
                static_cast<double>(model_.dimension()));
  for (std::size_t m = 0; m < offsets_.size(); ++m) {
    const std::vector<Value> late = diffuse > 0.0 ? tail(grid) : std::vector<Value>(tones);
    for (std::size_t k = 0; k < tones; ++k) {
      const double delay = first / kSpeedOfLight;
      channel.h[m * tones + k] +=
          diffuse * late[k] *
              std::polar(1.0, -2.0 * std::numbers::pi * grid.frequency_hz(k) * delay) +
          rest * normal();
    }
  }
  return channel;
}

}  // namespace rayloc
