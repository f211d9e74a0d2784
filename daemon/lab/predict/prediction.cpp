#include "daemon/lab/predict/prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "capture/assemble/csi_receiver.h"
#include "daemon/lab/simulate/capture_simulator.h"
#include "daemon/site/scene/solid_around.h"
#include "engine/localize/localizer.h"

namespace rayloc {
namespace {

constexpr double kFromWalls = 0.15;  // [m], chosen: no device is held nearer
// Share of the Localizer's construction in the work, for the progress; measured: meeting room.
constexpr double kMaking = 0.2;
constexpr Duration kFrameInterval = std::chrono::milliseconds(20);
constexpr Duration kPointInterval = std::chrono::seconds(2);  // bursts of two points never merge
constexpr MacAddress kDevice{{0x02, 0x52, 0x4c, 0x00, 0x00, 0x01}};

// One access point: its recording, and the receiver of its frames.
struct Listener {
  CaptureSimulator simulator;
  CsiReceiver receiver;
};

Listener listener_of(const RoomModel& room, std::size_t index, const PredictionOptions& options) {
  CaptureOptions capture;
  capture.transmitter = kDevice;
  capture.pattern = room.device.pattern;
  capture.polarization = room.device.polarization;
  capture.bandwidth_mhz = options.bandwidth_mhz;
  capture.trace = room.trace;
  capture.model_error = true;
  capture.impairments = default_impairments();
  capture.seed = options.seed;
  CsiReceiverOptions receiver;
  receiver.access_point = index;
  receiver.expected_rx_chains = room.access_points[index].rx_chains;
  return {CaptureSimulator(room, index, capture), CsiReceiver(receiver)};
}

SimulatedPoint test_point_of(const Vec3d& position, std::size_t number, std::size_t frames) {
  SimulatedPoint test_point;
  test_point.position = position;
  const Timestamp begin =
      Timestamp(std::chrono::hours(24 * 365 * 50)) + static_cast<int>(number) * kPointInterval;
  for (std::size_t i = 0; i < frames; ++i) {
    const std::size_t of_all = number * frames + i;
    test_point.frames.push_back({begin + static_cast<int>(i) * kFrameInterval,
                                 static_cast<std::uint16_t>(of_all << 4U),
                                 of_all + 1});
  }
  return test_point;
}

Expected<std::vector<CsiFrame>> received_at(const SimulatedPoint& test_point,
                                            std::vector<Listener>& listeners) {
  std::vector<CsiFrame> frames;
  for (Listener& listener : listeners) {
    auto capture = listener.simulator.capture(test_point);
    RAYLOC_TRY(capture);
    for (const SimulatedDatagram& datagram : capture->datagrams) {
      listener.receiver.push({datagram.time, {}, datagram.payload}, frames);
    }
    listener.receiver.flush(frames);
  }
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  return frames;
}

double horizontal(const Vec3d& a, const Vec3d& b) { return std::hypot(a.x - b.x, a.y - b.y); }

void add_draw(const LocationEstimate& estimate, PredictedPlace& place) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  place.estimate.push_back(estimate.position.value_or(Vec3d{kNone, kNone, kNone}));
  place.error.push_back(estimate.position ? horizontal(*estimate.position, place.position)
                                          : std::numeric_limits<double>::infinity());
}

void summarise(Prediction& prediction) {
  std::vector<double> errors;
  for (const PredictedPlace& place : prediction.places) {
    errors.insert(errors.end(), place.error.begin(), place.error.end());
  }
  if (errors.empty()) {
    return;
  }
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double share) {
    return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
  };
  prediction.median_m = at(0.5);
  prediction.p90_m = at(0.9);
  prediction.another_place = misplaced_share(errors);
}

}  // namespace

double misplaced_share(std::span<const double> errors) {
  const auto far = std::count_if(
      errors.begin(), errors.end(), [](double error) { return error > kAnotherPlace; });
  return static_cast<double>(far) / static_cast<double>(errors.size());
}

std::vector<Vec3d> predicted_places(const RoomModel& room, double step) {
  std::vector<Vec3d> places;
  const auto count = [&](double from, double to) {
    return static_cast<int>(std::floor((to - from - 2.0 * kFromWalls) / step)) + 1;
  };
  const int count_x = count(room.bounds_min.x, room.bounds_max.x);
  const int count_y = count(room.bounds_min.y, room.bounds_max.y);
  // Equal distances from both walls.
  const double first_x = 0.5 * (room.bounds_min.x + room.bounds_max.x - (count_x - 1) * step);
  const double first_y = 0.5 * (room.bounds_min.y + room.bounds_max.y - (count_y - 1) * step);
  for (int i = 0; i < count_x; ++i) {
    for (int j = 0; j < count_y; ++j) {
      const Vec3d place{first_x + i * step, first_y + j * step, room.device.height};
      if (!solid_around(*room.scene, place)) {
        places.push_back(place);
      }
    }
  }
  return places;
}

Expected<Prediction> predict(const std::shared_ptr<const RoomModel>& room,
                             const std::vector<Vec3d>& places,
                             const PredictionOptions& options) {
  const auto report = [&](double share) {
    if (options.progress) {
      options.progress(share);
    }
  };
  report(0.0);
  LocalizerOptions localizer_options;
  localizer_options.path_grids = options.path_grids;
  const auto localizer = Localizer::create(room, localizer_options);
  RAYLOC_TRY(localizer);
  std::vector<Listener> listeners;
  for (std::size_t i = 0; i < room->access_points.size(); ++i) {
    listeners.push_back(listener_of(*room, i, options));
  }
  Prediction prediction;
  std::size_t number = 0;
  for (const Vec3d& position : places) {
    report(kMaking + (1.0 - kMaking) * static_cast<double>(prediction.places.size()) /
                         static_cast<double>(places.size()));
    PredictedPlace place{position, {}, {}};
    for (std::size_t draw = 0; draw < options.draws; ++draw) {
      const auto frames = received_at(test_point_of(position, number++, options.frames), listeners);
      RAYLOC_TRY(frames);
      add_draw(frames->empty() ? LocationEstimate() : localizer->locate(*frames), place);
    }
    prediction.places.push_back(std::move(place));
  }
  summarise(prediction);
  report(1.0);
  return prediction;
}

std::vector<ConfusedPlace> confused_places(const Prediction& prediction, std::size_t most) {
  std::vector<ConfusedPlace> found;
  for (const PredictedPlace& place : prediction.places) {
    const std::size_t first = found.size();
    for (std::size_t i = 0; i < place.error.size(); ++i) {
      if (!(place.error[i] > kAnotherPlace) || !std::isfinite(place.error[i])) {
        continue;
      }
      const auto same = std::find_if(
          found.begin() + static_cast<std::ptrdiff_t>(first), found.end(), [&](const auto& one) {
            return horizontal(one.taken_for, place.estimate[i]) < kAnotherPlace;
          });
      if (same == found.end()) {
        found.push_back({place.position, place.estimate[i], 1, place.error.size()});
      } else {
        ++same->count;
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const ConfusedPlace& a, const ConfusedPlace& b) {
    return a.count > b.count;
  });
  found.resize(std::min(found.size(), most));
  return found;
}

}  // namespace rayloc
