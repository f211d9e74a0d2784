#include "daemon/service/service.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "daemon/config/secrets.h"
#include "daemon/log/log.h"
#include "daemon/pipeline/record/recording_folder.h"
#include "daemon/pipeline/record/system_now.h"
#include "daemon/service/curve_access.h"
#include "daemon/service/passed_socket_check.h"
#include "daemon/service/place_check.h"
#include "daemon/service/privacy.h"
#include "daemon/site/path_grid_files.h"
#include "daemon/site/room_match.h"

namespace rayloc {
namespace {

constexpr std::size_t kSubjectsShown = 2048;       // on the map
constexpr std::size_t kPlayedFrames = 512;         // that wait of a source that people move
constexpr const char* kChainFile = "chains.json";  // in the state directory
constexpr auto kRepeatWarning = std::chrono::minutes(10);

RecordingLimits recording_limits(const RecordConfig& config) {
  return {.rotate_bytes = config.rotate_bytes,
          .rotate_every = config.rotate_every,
          .max_total_bytes = config.max_total_bytes,
          .min_free_bytes = config.min_free_bytes};
}

RingSnapshots::Limits snapshot_limits(const RecordConfig& config) {
  return {.max_total_bytes = config.max_total_bytes, .min_free_bytes = config.min_free_bytes};
}

// Empty when nobody has said where.
std::filesystem::path state_folder() {
  const char* const state = std::getenv("STATE_DIRECTORY");  // systemd.exec(5)
  return state != nullptr ? std::filesystem::path(state) : std::filesystem::path();
}

std::filesystem::path snapshot_folder(const RecordConfig& config) {
  return !config.snapshot_directory.empty() ? config.snapshot_directory
         : !config.directory.empty()        ? config.directory
                                            : state_folder();
}

std::unique_ptr<RecorderStage> open_recorder(const RecordConfig& config,
                                             const std::string& access_point) {
  RotatingRecorderOptions options;
  options.folder = config.directory;
  options.name = access_point;
  options.limits = recording_limits(config);
  return std::make_unique<RecorderStage>(std::make_unique<RotatingRecorder>(std::move(options)));
}

// Null where they are not to be kept, or nobody knows where.
std::shared_ptr<PathGridStore> path_grids(const CacheConfig& config,
                                          const std::function<void(const std::string& line)>& log) {
  if (!config.enabled) {
    return nullptr;
  }
  const auto directory =
      config.directory.empty() ? cache_directory() : std::optional(config.directory);
  if (!directory) {
    log("no folder for caches is known: set directory in [cache]");
    return nullptr;
  }
  PathGridFiles::Options files;
  files.directory = *directory;
  files.log = log;
  return std::make_shared<PathGridFiles>(std::move(files));
}

PipelineOptions pipeline_options(const DaemonConfig& config, bool playback) {
  PipelineOptions options;
  options.burst.length = config.engine.burst;
  options.burst.max_transmitters = config.limits.max_targets;
  options.ring_frames = config.limits.ring_frames;
  // Recordings can wait until everything that came before has been explained.
  if (std::none_of(config.sources.begin(), config.sources.end(), is_live)) {
    options.overflow = Overflow::kWait;
  }
  if (playback) {  // what is shown follows it closely
    options.ring_frames = std::min(options.ring_frames, kPlayedFrames);
  }
  return options;
}

}  // namespace

Expected<std::unique_ptr<Service>> Service::open(
    DaemonSetup setup,
    PassedSockets& sockets,
    const std::function<void(const std::string& line)>& log) {
  std::unique_ptr<Service> service(new Service(std::move(setup)));
  const DaemonConfig& config = service->setup_.config;
  service->status_.started = system_now();

  for (const Expected<void>& good : {check_secrets(config),
                                     check_passed_sockets(sockets, config),
                                     check_places(config, sockets),
                                     service->check_resources(false)}) {
    if (!good) {
      return tl::make_unexpected(good.error());
    }
  }
  log("preparing the room of site '" + service->setup_.site.name + "'");
  if (const Expected<void> opened = service->open_estimators(path_grids(config.cache, log));
      !opened) {
    return tl::make_unexpected(opened.error());
  }
  service->status_.georeference = service->setup_.site.georeference;
  service->status_.people = service->people_.get();
  if (const DeviceEstimator* estimator = service->estimator_.get(); estimator != nullptr) {
    service->status_.estimator = estimator;
    const RoomModel& room = estimator->room();
    service->status_.scene_hash = room.scene_hash;
    service->status_.calibration_id = room.calibration_id;
    for (const SceneNote& note : room.scene->notes()) {
      log(to_line(note));
    }
    for (const std::string& warning : room_warnings(*room.scene, service->setup_.site)) {
      log(warning);
    }
  }

  service->look_at_site();
  if (const Expected<void> opened = service->open_publishing(sockets); !opened) {
    return tl::make_unexpected(opened.error());
  }
  if (const auto snapshots = snapshot_folder(config.record);
      !snapshots.empty() && snapshots != config.record.directory) {
    repair_recordings(snapshots, service->status_.started, log);
  }
  if (!config.record.directory.empty()) {
    service->status_.recordings_repaired =
        repair_recordings(config.record.directory, service->status_.started, log);
  }
  std::vector<SourceWorker::Input> inputs;
  if (const Expected<void> opened = service->open_sources(sockets, inputs); !opened) {
    return tl::make_unexpected(opened.error());
  }
  const bool playback = service->recording_clock_.playback != nullptr;
  service->pipeline_ = std::make_unique<Pipeline>(pipeline_options(config, playback),
                                                  std::move(inputs),
                                                  *service->zones_,
                                                  *service->publisher_);
  service->status_.pipeline = service->pipeline_.get();
  service->status_.publisher = service->publisher_.get();
  if (const Expected<void> http = service->open_http(sockets); !http) {
    return tl::make_unexpected(http.error());
  }
  return service;
}

Expected<void> Service::open_publishing(PassedSockets& sockets) {
  if (const Expected<void> enough = check_resources(true); !enough) {
    return tl::make_unexpected(enough.error());
  }
  const DaemonConfig& config = setup_.config;
  auto guard = open_curve_access(config.curve, limited_log_, [this] { guard_progress_.beat(); });
  if (!guard) {
    return tl::make_unexpected(guard.error());
  }
  guard_ = std::move(*guard);
  PublisherOptions publishing;
  publishing.guard = guard_;
  publishing.endpoint = config.publish.endpoint;
  publishing.adopted_fd = sockets.take("publish").value_or(-1);
  publishing.site = setup_.site.name;
  publishing.epoch = random_epoch();
  status_.epoch = publishing.epoch;
  last_messages_ = std::make_shared<LastMessages>(publishing.max_topics);
  publishing.last = last_messages_;
  if (config.http.enabled) {
    message_board_ = std::make_shared<MessageBoard>(kSubjectsShown);
    publishing.board = message_board_;
  }
  publishing.high_water_mark = static_cast<int>(config.publish.send_high_water_mark);
  Expected<Publisher> publisher = Publisher::bind(publishing);
  if (!publisher) {
    return tl::make_unexpected(publisher.error());
  }
  SnapshotServer::Options snapshots;
  snapshots.endpoint = config.publish.snapshot;
  snapshots.adopted_fd = sockets.take("snapshot").value_or(-1);
  snapshots.epoch = publishing.epoch;
  snapshots.last = last_messages_;
  snapshots.guard = guard_;
  snapshots.on_round = [this] { snapshots_progress_.beat(); };
  auto snapshot_server = SnapshotServer::open(snapshots);
  if (!snapshot_server) {
    return tl::make_unexpected(snapshot_server.error());
  }
  snapshots_ = std::move(*snapshot_server);
  status_.snapshots = snapshots_.get();
  PublisherStage::Options stage;
  stage.heartbeat = config.publish.heartbeat;
  stage.status = [this](Timestamp now) { return status_messages(status_, now); };
  stage.now = system_now;
  if (std::any_of(config.sources.begin(), config.sources.end(), is_live)) {
    status_.clock = std::make_shared<ClockOffset>();
    stage.clock_ahead = [clock = status_.clock] { return clock->now(); };
  }
  stage.name = [this](const CsiFrame& frame) {
    return transmitter_name(setup_.site, frame, *names_);
  };
  publisher_ = std::make_unique<PublisherStage>(std::move(*publisher), std::move(stage));
  return {};
}

Expected<void> Service::open_estimators(std::shared_ptr<PathGridStore> path_grids) {
  auto names = open_target_names(setup_.config);
  if (!names) {
    return tl::make_unexpected(names.error());
  }
  names_ = std::move(*names);
  zones_ = std::make_unique<ZoneEstimator>(estimators_, setup_.site.zones);
  const Method* method = setup_.config.engine.method;
  if (method == nullptr) {
    return {};
  }
  MethodOptions settings;
  settings.accuracy_confidence = setup_.config.engine.accuracy_confidence;
  settings.path_grids = std::move(path_grids);
  if (method->create_device != nullptr) {
    DeviceEstimator::Options devices;
    devices.method = method;
    devices.settings = settings;
    devices.names = names_;
    devices.snapshots =
        setup_.config.engine.snapshots_always ? Snapshots::kAlways : Snapshots::kAcquire;
    if (const auto folder = state_folder(); !folder.empty()) {
      devices.chains = {(folder / kChainFile).string(), (folder / kChainFile).string()};
    }
    auto estimator = DeviceEstimator::create(setup_.site, devices);
    if (!estimator) {
      return tl::make_unexpected(estimator.error());
    }
    estimator_ = std::move(*estimator);
    estimators_.add(*estimator_);
  }
  if (method->create_person != nullptr && setup_.site.reference_file) {
    PersonEstimator::Options options;
    options.method = method;
    options.settings = settings;
    auto people = PersonEstimator::create(setup_.site, options);
    if (!people) {
      return tl::make_unexpected(people.error());
    }
    people_ = std::move(*people);
    estimators_.add(*people_);
  }
  return {};
}

// What it cannot locate is said at the start, and as long as it runs.
void Service::look_at_site() {
  if (estimator_) {
    lacks_ = lacks_of(setup_, estimator_->room());
  }
  for (const std::string& text : lacks_.all()) {
    log_event({LogLevel::kWarning, text});
  }
  status_.warnings = [this] { return warnings_for_everybody(health()); };
}

Expected<void> Service::open_sources(PassedSockets& sockets,
                                     std::vector<SourceWorker::Input>& inputs) {
  auto clock = recording_clock(setup_.config);
  if (!clock) {
    return tl::make_unexpected(clock.error());
  }
  recording_clock_ = std::move(*clock);
  status_.playback = recording_clock_.playback;
  for (const SourceConfig& source : setup_.config.sources) {
    const std::optional<int> passed =
        takes_socket(source) ? sockets.take("source-" + source.access_point) : std::nullopt;
    Expected<SourceWorker::Input> input =
        open_source(source, setup_.site, passed, recording_clock_);
    if (!input) {
      return tl::make_unexpected(input.error());
    }
    if (!setup_.config.record.directory.empty()) {
      recorders_.push_back(open_recorder(setup_.config.record, source.access_point));
      input->taps.push_back(recorders_.back().get());
      status_.recorders.push_back(recorders_.back().get());
    }
    add_ring(*input);
    input->frame_tap = setup_.config.publish.csi ? publisher_.get() : nullptr;
    status_.sources.push_back({is_live(source), source.stall_after});
    inputs.push_back(std::move(*input));
  }
  open_snapshots();
  return {};
}

void Service::open_snapshots() {
  std::vector<RingSnapshots::Source> sources;
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    sources.push_back({setup_.config.sources[i].access_point, rings_[i].get()});
  }
  const RecordConfig& config = setup_.config.record;
  if (!sources.empty()) {
    snapshots_of_rings_ = std::make_unique<RingSnapshots>(
        std::move(sources), snapshot_folder(config), snapshot_limits(config));
    status_.ring_snapshots = snapshots_of_rings_.get();
  }
}

Expected<std::vector<std::string>> Service::snapshot() {
  if (!snapshots_of_rings_) {
    return make_error(ErrorKind::kUnavailable,
                      "nothing is kept for a snapshot; set snapshot_directory, and ring_s above 0, "
                      "in [record]");
  }
  return snapshots_of_rings_->request();
}

std::vector<std::string> Service::news() {
  auto lines = snapshots_of_rings_ ? snapshots_of_rings_->news() : std::vector<std::string>();
  if (estimator_) {
    const auto chains = estimator_->chain_news();
    lines.insert(lines.end(), chains.begin(), chains.end());
  }
  return lines;
}

// What is kept in memory of a source, when there is somewhere to write it.
void Service::add_ring(SourceWorker::Input& input) {
  const RecordConfig& config = setup_.config.record;
  if (config.ring <= Duration::zero() || snapshot_folder(config).empty()) {
    return;
  }
  rings_.push_back(std::make_unique<DatagramRing>(config.ring, config.ring_bytes));
  input.taps.push_back(rings_.back().get());
}

void Service::apply(const DaemonConfig& config) {
  publisher_->set_heartbeat(config.publish.heartbeat);
  for (const auto& recorder : recorders_) {
    recorder->set_limits(recording_limits(config.record));
  }
  if (snapshots_of_rings_) {
    snapshots_of_rings_->set_limits(snapshot_limits(config.record));
  }
  guard_->allow(config.curve.allow);
}

std::string Service::status_line() const {
  const std::vector<SourceReport> reports = pipeline_->source_reports();
  std::uint64_t received = 0;
  std::uint64_t kernel_drops = 0;
  std::uint64_t heard = 0;
  for (const SourceReport& report : reports) {
    received += report.source.received;
    kernel_drops += report.source.kernel_drops;
    heard += report.source.delivered > 0 ? 1U : 0U;
  }
  const EstimationCounters estimation = pipeline_->estimation_counters();
  return fmt::format("{} of {} sources heard; {} datagrams, {} dropped by the kernel; {} fixes{}",
                     heard,
                     reports.size(),
                     received,
                     kernel_drops,
                     estimation.snapshots - estimation.no_fix,
                     health().reload_failed ? "; the last reload failed" : "");
}

std::vector<std::string> Service::source_descriptions() const {
  std::vector<std::string> lines;
  for (const SourceReport& report : pipeline_->source_reports()) {
    lines.push_back(report.access_point + ": " + report.description);
  }
  return lines;
}

std::vector<std::string> Service::new_warnings() {
  const auto now = std::chrono::steady_clock::now();
  std::vector<std::string> fresh;
  if (!estimator_) {
    return fresh;
  }
  for (const CalibrationWarning& warning : estimator_->calibration_warnings()) {
    const auto told =
        std::find_if(told_warnings_.begin(), told_warnings_.end(), [&](const ToldWarning& one) {
          return one.warning.same_as(warning);
        });
    if (told == told_warnings_.end()) {
      told_warnings_.push_back({warning, now});
    } else if (now - told->time >= kRepeatWarning) {
      told->time = now;
    } else {
      continue;
    }
    fresh.push_back(warning.text);
  }
  return fresh;
}

Readiness Service::readiness() const {
  return rayloc::readiness(status_messages(status_, system_now()), health());
}

void Service::log_losses() {
  const v1::Heartbeat heartbeat = status_messages(status_, system_now()).heartbeat;
  losses_.look(heartbeat);
  losses_.look_at_log(log_entries_dropped());
  limited_log_->flush();
  const std::lock_guard lock(health_mutex_);
  saturation_.look(heartbeat, std::chrono::steady_clock::now());
}

std::vector<std::string> Service::new_errors() {
  std::vector<std::string> errors;
  for (const SourceReport& report : pipeline_->source_reports()) {
    if (!report.error.empty()) {
      errors.push_back("source " + report.access_point +
                       (report.ended ? " has ended: " : " cannot be read, it is opened again: ") +
                       report.error);
    }
  }
  for (const auto& recorder : recorders_) {
    if (const std::string error = recorder->counters().files.error; !error.empty()) {
      errors.push_back("recording: " + error);
    }
  }
  std::vector<std::string> fresh;
  const auto holds = [](const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
  };
  for (const std::string& error : errors) {
    if (!holds(told_errors_, error) && !holds(fresh, error)) {
      fresh.push_back(error);
    }
  }
  for (const std::string& error : told_errors_) {
    if (!holds(errors, error)) {
      ended_errors_.push_back(error);
    }
  }
  told_errors_ = std::move(errors);
  return fresh;
}

std::vector<std::string> Service::ended_errors() { return std::exchange(ended_errors_, {}); }

}  // namespace rayloc
