#include "daemon/live/service/site/site_api.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "daemon/live/live_map/map_channel.h"
#include "daemon/live/live_map/map_events.h"
#include "daemon/live/live_map/map_geometry.h"
#include "daemon/live/live_map/map_presence.h"
#include "daemon/live/live_map/map_solid.h"
#include "daemon/live/studio/pdf_page.h"
#include "daemon/messages/topic.h"
#include "daemon/pipeline/record/recording_folder.h"
#include "daemon/pipeline/record/system_now.h"

namespace rayloc {
namespace {

// The method of the site, and those that are compared with it.
std::vector<std::string> names_of_methods(const EngineConfig& engine) {
  std::vector<std::string> names{std::string(engine.method->name)};
  for (const Method* method : engine.compared) {
    names.emplace_back(method->name);
  }
  return names;
}

// AP=FILE for the recordings of its sources since then, as `rayloc calibrate --capture` takes it.
Expected<std::vector<std::string>> recorded_captures(const DaemonConfig& config, Timestamp since) {
  if (config.record.directory.empty()) {
    return bad_input(
        "nothing is recorded, so a survey cannot be calibrated: set directory in [record] of " +
        config.file.string() + ", start raylocd again, and walk the survey then");
  }
  std::vector<std::string> captures;
  for (const SourceConfig& source : config.sources) {
    for (const std::filesystem::path& file :
         recordings_since(config.record.directory, source.access_point, since)) {
      captures.push_back(source.access_point + "=" + file.string());
    }
  }
  if (captures.empty()) {
    return bad_input(config.record.directory.string() +
                     ": no recording of the time of the survey is left; walk it again");
  }
  return captures;
}

void offer_editor(const RunningSite& running, SiteApiOptions& options, SiteApi& api) {
  const std::filesystem::path& folder = running.runtime->setup().site.directory;
  api.editor = std::make_shared<const SiteEditor>(folder, std::move(options.on_saved));
  api.survey = std::make_shared<WalkedSurvey>(folder / "survey.csv", [runtime = running.runtime] {
    WalkedSurvey::Frames frames;
    const StatusMessages status = runtime->status(system_now());
    for (const v1::SourceReport& source : status.heartbeat.sources()) {
      frames[source.access_point()] += source.counters().frames_complete();
    }
    return frames;
  });
  const SiteSet::Site& before = options.before;
  if (before && before->api && before->api->calibration_job &&
      before->runtime->setup().site.directory == folder) {
    // Either may run, and outlives a reload.
    api.calibration_job = before->api->calibration_job;
    api.plan = before->api->plan;
    return;
  }
  api.plan = std::make_shared<PdfPage>();
  api.calibration_job = std::make_shared<CalibrationJob>(
      folder, [config = running.runtime->setup().config](Timestamp since) {
        return recorded_captures(config, since);
      });
}

}  // namespace

void open_site_api(RunningSite& running, SiteApiOptions options) {
  SiteRuntime& runtime = *running.runtime;
  SiteApi api;
  api.component = topic_component(running.name());
  api.status = [runtime = running.runtime, output = running.output] {
    return runtime->status(system_now());
  };
  api.readiness = std::move(options.readiness);
  api.playback = runtime.playback();
  api.last = std::move(options.last);
  api.events = std::make_shared<MapEvents>(running.board, options.epoch, system_now);
  api.presence = [board = running.board] { return map_presence_json(*board, system_now()); };
  const Site& site = runtime.setup().site;
  api.channel = [] { return std::string("[]\n"); };
  if (const RoomModel* const room = runtime.room(); room != nullptr) {
    const EngineConfig& engine = runtime.setup().config.engine;
    api.map = map_geometry_json(site, *room, names_of_methods(engine), !runtime.names_hashed());
    api.solid = map_solid_json(*room->scene);
    api.calibration = map_calibration_json(site, *room);
  } else {
    const std::string reason = "nothing is located here ([engine] method is \"none\")";
    api.map = map_without_room_json(site, reason);
    api.solid = map_without_room_json(site, reason);
    api.calibration = map_without_calibration_json(reason);
  }
  if (DeviceEstimator* const estimator = runtime.estimator(); estimator != nullptr) {
    const auto channel = std::make_shared<MapChannel>(estimator->channels());
    running.channel = std::make_shared<BackgroundText>(
        [keep = running.runtime, channel] { return channel->json(); }, "[]\n");
    api.channel = [text = running.channel] { return text->ask(); };
  }
  if (options.on_saved) {
    offer_editor(running, options, api);
  }
  running.api = std::make_shared<const SiteApi>(std::move(api));
}

}  // namespace rayloc
