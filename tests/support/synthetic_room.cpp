#include "tests/support/synthetic_room.h"

#include <cmath>
#include <numbers>

#include "engine/room/ray.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/scenes.h"

namespace rayloc::test {
namespace {

using Value = std::complex<double>;

constexpr double kHalfX = 1.5;  // [m]
constexpr double kHalfY = 1.2;
constexpr double kTop = 2.5;
constexpr double kHeight = 1.2;

OfdmGrid make_grid() {
  OfdmGrid grid{kCarrier, 312'500.0, {}};
  for (int k = -58; k <= 58; k += 2) {
    if (k != 0) {
      grid.tone_index.push_back(static_cast<std::int16_t>(k));
    }
  }
  return grid;
}

RoomAccessPoint make_access_point(const std::string& id, double x, double y) {
  RoomAccessPoint ap;
  ap.id = id;
  ap.array.pose.position = {x, y, kHeight};
  ap.array.pose.orientation.yaw = std::atan2(-y, -x);  // faces the middle
  ap.array.element_offset = {{0.0, -0.089, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.089, 0.0}};
  ap.array.pattern = AntennaPattern::kHalfWaveDipole;
  ap.rx_chains = {2, 0, 3};
  return ap;
}

}  // namespace

ChainGains make_gains(const RoomModel& room, std::size_t access_point) {
  const RoomAccessPoint& ap = room.access_points[access_point];
  ChainGains gains{room.grid, ap.rx_chains, {}, {}};
  for (std::size_t rx_chain = 0; rx_chain < ap.rx_chains.size(); ++rx_chain) {
    const auto number = static_cast<double>(rx_chain + 3 * access_point);
    const Value level = std::polar(1.0 + 0.15 * std::sin(number), 2.1 * number);
    for (std::size_t k = 0; k < room.grid.size(); ++k) {
      const double x = room.grid.tone_index[k] / 58.0;
      gains.gain.push_back(level * std::polar(1.0 + 0.03 * x, 0.05 * x * x));
    }
  }
  return gains;
}

RoomModel make_room() {
  RoomModel room;
  room.name = "synthetic";
  room.scene =
      make_scene({{"west", box_mesh({-kHalfX - 0.1, -kHalfY, 0}, {-kHalfX, kHalfY, kTop})},
                  {"east", box_mesh({kHalfX, -kHalfY, 0}, {kHalfX + 0.1, kHalfY, kTop})},
                  {"south", box_mesh({-kHalfX, -kHalfY - 0.1, 0}, {kHalfX, -kHalfY, kTop})},
                  {"north", box_mesh({-kHalfX, kHalfY, 0}, {kHalfX, kHalfY + 0.1, kTop})},
                  {"floor", box_mesh({-kHalfX, -kHalfY, -0.1}, {kHalfX, kHalfY, 0})}},
                 kConcrete);
  room.bounds_min = {-kHalfX, -kHalfY, 0.0};
  room.bounds_max = {kHalfX, kHalfY, kTop};
  room.grid = make_grid();
  room.device.height = kHeight;
  room.access_points = {make_access_point("a", -1.3, 1.0),
                        make_access_point("b", 1.35, 0.9),
                        make_access_point("c", -0.2, -1.05)};
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    room.access_points[i].gains = make_gains(room, i);
  }
  return room;
}

std::vector<Value> channel_at(const RoomModel& room,
                              const RoomAccessPoint& ap,
                              const Vec3d& position) {
  const PathTracer tracer(room.scene, room.trace);
  const Transmitter device{{position, {}, room.device.pattern, room.device.polarization}};
  std::vector<Value> h;
  for (const Receiver& element : array_elements<Receiver>(ap.array)) {
    const auto row = tracer.trace(device, element).cfr(room.grid);
    h.insert(h.end(), row.begin(), row.end());
  }
  return h;
}

std::vector<CsiFrame> frames_at(const RoomModel& room,
                                const Vec3d& position,
                                const FrameOptions& options) {
  std::vector<std::vector<Value>> channels;
  for (const RoomAccessPoint& ap : room.access_points) {
    channels.push_back(channel_at(room, ap, position));
  }
  return frames_of(room, channels, options);
}

std::vector<Ray> rays_to(const PathTracer& tracer,
                         const RoomModel& room,
                         const AntennaArray& array,
                         const Vec3d& position) {
  const Transmitter device{{position, {}, room.device.pattern, room.device.polarization}};
  return rays_of(tracer.trace(device, array_origin<Receiver>(array)), room, position, kMaxRays);
}

std::vector<CsiFrame> frames_of(const RoomModel& room,
                                const std::vector<std::vector<Value>>& channels,
                                const FrameOptions& options) {
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<CsiFrame> frames;
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    const RoomAccessPoint& ap = room.access_points[i];
    auto h = channels[i];
    if (h.empty()) {
      continue;
    }
    apply_coupling(ap.gains, h);
    const ChainGains gains = make_gains(room, i);
    double power = 0.0;
    for (std::size_t j = 0; j < h.size(); ++j) {
      h[j] *= gains.gain[j];
      power += std::norm(h[j]) / static_cast<double>(h.size());
    }
    const double sigma = std::sqrt(0.5 * power * std::pow(10.0, -0.1 * options.snr_db));
    for (int n = 0; n < options.count; ++n) {
      CsiFrame frame;
      frame.time = Timestamp(std::chrono::milliseconds(10 * n));
      frame.access_point = i;
      frame.rx_chains = ap.rx_chains;
      frame.tone_index = room.grid.tone_index;
      frame.complete = true;
      frame.csi = Csi(ap.rx_chains.size(), 1, room.grid.size());
      // Drawn one by one: the order in which arguments are evaluated differs between compilers.
      const double phase = 2.0 * std::numbers::pi * uniform(random);
      const Value factor = std::polar(std::exp(normal(random)), phase);
      const double delay = 60e-9 + 290e-9 * uniform(random);
      for (std::size_t m = 0; m < ap.rx_chains.size(); ++m) {
        const auto row = frame.csi.row(m, 0);
        for (std::size_t k = 0; k < room.grid.size(); ++k) {
          const double imaginary = sigma * normal(random);
          const Value noise(sigma * normal(random), imaginary);
          const Value turn =
              std::polar(1.0, -2.0 * std::numbers::pi * room.grid.offset_hz(k) * delay);
          row[k] = std::complex<float>(factor * (turn * h[m * room.grid.size() + k] + noise));
        }
      }
      frames.push_back(std::move(frame));
    }
  }
  return frames;
}

}  // namespace rayloc::test
