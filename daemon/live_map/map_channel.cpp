#include "daemon/live_map/map_channel.h"

#include <cmath>
#include <complex>
#include <span>
#include <utility>
#include <vector>

#include <google/protobuf/util/time_util.h>
#include <nlohmann/json.hpp>

#include "daemon/publish/proto_time.h"
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

// [antenna][tone], every ray as it was traced: the likelihood believes less of the reflections.
std::vector<std::complex<double>> simulate(const ReceiverTracer& tracer,
                                           const RoomModel& room,
                                           const RoomAccessPoint& access_point,
                                           const Vec3d& position) {
  const std::vector<Vec3d> offsets = offsets_of(access_point.array);
  const DeviceModel& device = room.device;
  const Transmitter transmitter{{position, {}, device.pattern, device.polarization}};
  const std::vector<Ray> rays = rays_of(tracer.trace(transmitter), room, position, kMostRays);
  ModelError none = access_point.error;
  none.plan_tolerance = 0.0;
  return ObservationModel(room.grid, offsets.size(), PathKnowledge::kFull)
      .expected({rays, offsets}, none);
}

Json array_json(const HeardArray& heard,
                std::vector<std::complex<double>> simulated,
                const OfdmGrid& grid) {
  const std::size_t tones = grid.size();
  double power = 0.0;
  for (const std::complex<double>& value : heard.h) {
    power += std::norm(value);
  }
  // 1: root mean square of what was measured, over antennas and tones.
  const double scale = std::sqrt(static_cast<double>(heard.h.size()) / power);
  const Aligner aligner(grid);
  const Alignment alignment = aligner.align(heard.h, simulated);
  aligner.apply(alignment, simulated);
  Json antennas = Json::array();
  for (std::size_t i = 0; i < heard.map->antennas(); ++i) {
    antennas.push_back(
        {{"measured", amplitudes(std::span(heard.h).subspan(i * tones, tones), scale)},
         {"simulated", amplitudes(std::span(simulated).subspan(i * tones, tones), scale)}});
  }
  return {{"id", heard.map->access_point().id},
          {"correlation", alignment.correlation},
          {"antennas", std::move(antennas)}};
}

}  // namespace

const ReceiverTracer& MapChannel::tracer_at(const ChannelWatch::Sight& sight,
                                            const RoomAccessPoint& at) {
  const auto key = std::pair(sight.localizer, at.id);
  const auto found = tracers_.find(key);
  if (found != tracers_.end()) {
    return found->second;
  }
  const RoomModel& room = sight.localizer->room();
  const auto centre = array_origin<Receiver>(at.array);
  return tracers_.emplace(key, PathTracer(room.scene, room.trace).at(centre)).first->second;
}

std::string MapChannel::sight_json(const ChannelWatch::Sight& sight) {
  const RoomObservation observation = sight.localizer->hear(sight.frames);
  const OfdmGrid& grid = sight.localizer->room().grid;
  Json arrays = Json::array();
  for (const HeardArray& heard : observation.arrays) {
    const RoomAccessPoint& at = heard.map->access_point();
    auto simulated = simulate(tracer_at(sight, at), sight.localizer->room(), at, sight.position);
    if (simulated.size() != heard.h.size()) {  // it is heard without a chain that is dead
      simulated = heard.map->expected(heard.map->rays_to(sight.position));
    }
    arrays.push_back(array_json(heard, std::move(simulated), grid));
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
