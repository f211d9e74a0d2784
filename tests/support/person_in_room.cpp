#include "tests/support/person_in_room.h"

#include "engine/person/calibrate/empty_room.h"
#include "engine/room/preprocess_burst.h"
#include "engine/trace/scattering/scattering.h"

namespace rayloc::test {

Transmitter fixed_transmitter() {
  return {{{1.2, -0.8, 1.2}, {}, AntennaPattern::kHalfWaveDipole, Polarization::kVertical}};
}

std::vector<std::vector<std::complex<double>>> channels_past(
    const RoomModel& room, const std::vector<TargetPosition>& places, const TargetBody& body) {
  ScatteringOptions options;
  options.trace = room.trace;
  options.trace.max_depth = room.trace.max_depth + 1;
  const auto tracer = TargetTracer::create(room.scene, body, options);
  std::vector<std::vector<std::complex<double>>> channels;
  for (const RoomAccessPoint& ap : room.access_points) {
    auto h = channel_at(room, ap, fixed_transmitter().position);
    const auto elements = array_elements<Receiver>(ap.array);
    const auto links = tracer->links(fixed_transmitter(), elements);
    for (std::size_t m = 0; m < links.size(); ++m) {
      for (const TargetPosition& place : places) {
        const auto row = links[m].trace(place)->cfr(room.grid);
        for (std::size_t k = 0; k < row.size(); ++k) {
          h[m * row.size() + k] += row[k];
        }
      }
    }
    channels.push_back(std::move(h));
  }
  return channels;
}

std::vector<CsiFrame> frames_past(const RoomModel& room,
                                  const std::vector<TargetPosition>& places,
                                  const TargetBody& body,
                                  const FrameOptions& options) {
  return frames_of(room, channels_past(room, places, body), options);
}

std::vector<std::complex<double>> direct_channel(const RoomModel& room, const RoomAccessPoint& ap) {
  RoomModel direct = room;
  direct.trace.max_depth = 0;
  return channel_at(direct, ap, fixed_transmitter().position);
}

PersonReference learn_reference(const RoomModel& room) {
  const auto frames = frames_past(room, {}, {}, {.count = 20, .snr_db = 35.0, .seed = 99});
  std::vector<EmptyRoom> received;
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    received.push_back({i, preprocess_burst(room, i, frames, {}, warnings)->h});
  }
  return *fit_empty_room(room, fixed_transmitter(), received);
}

}  // namespace rayloc::test
