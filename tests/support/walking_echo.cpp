#include "tests/support/walking_echo.h"

#include <complex>
#include <numbers>
#include <utility>

#include "engine/base/constants.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::test {

std::vector<CsiFrame> frames_past(const RoomModel& room,
                                  const WalkingEcho& link,
                                  double seconds,
                                  double step,
                                  const std::function<Vec3d(double)>& place) {
  std::vector<CsiFrame> frames;
  unsigned seed = 1;
  for (double t = 0.0; t < seconds; t += step) {
    const Vec3d person = place(t);
    std::vector<std::vector<std::complex<double>>> channels;
    for (const RoomAccessPoint& ap : room.access_points) {
      auto& h = channels.emplace_back();
      for (std::size_t m = 0; m < ap.rx_chains.size(); ++m) {
        const Vec3d antenna = element_position(ap.array, m);
        const double direct = norm(link.transmitter - antenna);
        const double echo = norm(link.transmitter - person) + norm(person - antenna);
        for (std::size_t k = 0; k < room.grid.size(); ++k) {
          const double wave = 2.0 * std::numbers::pi * room.grid.frequency_hz(k) / kSpeedOfLight;
          h.push_back(link.direct(m, k) / direct * std::polar(1.0, -wave * direct) +
                      link.echo / echo * std::polar(1.0, -wave * echo));
        }
      }
    }
    auto now = frames_of(room, channels, {.count = 1, .snr_db = link.snr_db, .seed = seed++});
    for (CsiFrame& frame : now) {
      frame.time = frame.time_last = Timestamp(from_seconds(t));
      frame.transmitter = link.mac;
      frames.push_back(std::move(frame));
    }
  }
  return frames;
}

}  // namespace rayloc::test
