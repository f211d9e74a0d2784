#include "daemon/live/live_map/map_channel.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>
#include <utility>
#include <vector>

#include <google/protobuf/util/time_util.h>
#include <nlohmann/json.hpp>

#include "daemon/messages/proto_time.h"
#include "engine/likelihood/observation_model.h"
#include "engine/localize/access_point_map.h"
#include "engine/observe/alignment.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

Json amplitudes(std::span<const std::complex<double>> row, double scale) {
  Json list = Json::array();
  for (const std::complex<double>& value : row) {
    list.push_back(std::round(1000.0 * scale * std::abs(value)) / 1000.0);
  }
  return list;
}

constexpr std::size_t kMaxPaths = 6;    // for one access point: more would be unreadable
constexpr double kWeakestPath = -20.0;  // [dB] below the strongest

// Paths of the wave from the device to the access point, the strongest first.
Json paths_json(const Paths& paths, const Vec3d& device, const Vec3d& access_point) {
  std::vector<const Path*> strongest_first;
  strongest_first.reserve(paths.size());
  for (const Path& path : paths) {
    strongest_first.push_back(&path);
  }
  std::sort(strongest_first.begin(), strongest_first.end(), [](const Path* a, const Path* b) {
    return abs2(a->a) > abs2(b->a);
  });
  Json list = Json::array();
  for (const Path* path : strongest_first) {
    const double power_db = 10.0 * std::log10(abs2(path->a) / abs2(strongest_first.front()->a));
    if (list.size() >= kMaxPaths || !(power_db >= kWeakestPath)) {
      break;
    }
    Json points = Json::array({{device.x, device.y, device.z}});
    for (const Interaction& one : path->interactions) {
      points.push_back({one.position.x, one.position.y, one.position.z});
    }
    points.push_back({access_point.x, access_point.y, access_point.z});
    list.push_back(
        {{"points", std::move(points)}, {"level_db", std::round(10.0 * power_db) / 10.0}});
  }
  return list;
}

// [antenna][tone], every ray as it was traced: the likelihood weights reflections less.
std::vector<std::complex<double>> simulate(const Paths& paths,
                                           const RoomModel& room,
                                           const RoomAccessPoint& access_point,
                                           const Vec3d& position) {
  const std::vector<Vec3d> offsets = offsets_of(access_point.array);
  const std::vector<Ray> rays = rays_of(paths, room, position, kMaxRays);
  ModelError none = access_point.error;
  none.plan_tolerance = 0.0;
  return ObservationModel(room.grid, offsets.size(), PathKnowledge::kFull)
      .expected({rays, offsets}, none);
}

Json array_json(const ArrayObservation& received,
                std::vector<std::complex<double>> simulated,
                const OfdmGrid& grid) {
  const std::size_t tones = grid.size();
  double power = 0.0;
  for (const std::complex<double>& value : received.h) {
    power += std::norm(value);
  }
  // 1: root mean square of the measured values, over antennas and tones.
  const double scale = std::sqrt(static_cast<double>(received.h.size()) / power);
  const Aligner aligner(grid);
  const Alignment alignment = aligner.align(received.h, simulated);
  aligner.apply(alignment, simulated);
  Json antennas = Json::array();
  for (std::size_t i = 0; i < received.map->antennas(); ++i) {
    antennas.push_back(
        {{"measured", amplitudes(std::span(received.h).subspan(i * tones, tones), scale)},
         {"simulated", amplitudes(std::span(simulated).subspan(i * tones, tones), scale)}});
  }
  return {{"id", received.map->access_point().id},
          {"correlation", alignment.correlation},
          {"antennas", std::move(antennas)}};
}

}  // namespace

const ReceiverTracer& MapChannel::tracer_at(const ChannelWatch::Sight& sight,
                                            const RoomAccessPoint& at) {
  const auto key = std::pair(sight.channel, at.id);
  const auto found = tracers_.find(key);
  if (found != tracers_.end()) {
    return found->second;
  }
  const RoomModel& room = sight.channel->room();
  const auto centre = array_origin<Receiver>(at.array);
  return tracers_.emplace(key, PathTracer(room.scene, room.trace).at(centre)).first->second;
}

std::string MapChannel::sight_json(const ChannelWatch::Sight& sight) {
  const RoomObservation observation = sight.channel->receive(sight.frames);
  const OfdmGrid& grid = sight.channel->room().grid;
  Json arrays = Json::array();
  for (const ArrayObservation& received : observation.arrays) {
    const RoomAccessPoint& at = received.map->access_point();
    const DeviceModel& device = sight.channel->room().device;
    const Paths paths = tracer_at(sight, at).trace(
        Transmitter{{sight.position, {}, device.pattern, device.polarization}});
    auto simulated = simulate(paths, sight.channel->room(), at, sight.position);
    if (simulated.size() != received.h.size()) {  // the measured channel lacks a dead chain
      simulated = received.map->expected(received.map->rays_to(sight.position));
    }
    arrays.push_back(array_json(received, std::move(simulated), grid));
    arrays.back()["paths"] = paths_json(paths, sight.position, at.array.pose.position);
  }
  return Json{{"target", sight.target},
              {"name", sight.name},
              {"time", google::protobuf::util::TimeUtil::ToString(to_proto(sight.time))},
              {"position", {sight.position.x, sight.position.y, sight.position.z}},
              {"tones", grid.tone_index},
              {"tone_spacing_hz", grid.spacing_hz},
              {"access_points", std::move(arrays)}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string MapChannel::json() {
  std::map<std::shared_ptr<const ChannelWatch::Sight>, std::string> made;
  std::string list;
  for (const auto& sight : watch_.ask()) {
    const auto before = made_.find(sight);
    const std::string& json = made[sight] =
        before == made_.end() ? sight_json(*sight) : before->second;
    list += (list.empty() ? "" : ",\n") + json;
  }
  made_ = std::move(made);
  return "[" + list + "]\n";
}

}  // namespace rayloc
