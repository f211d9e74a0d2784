#include "daemon/live/service/site/site_runtime.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "daemon/live/cluster/capture_report.h"
#include "daemon/live/cluster/feed_report.h"
#include "daemon/live/log/log.h"
#include "daemon/live/service/passed_socket_check.h"
#include "daemon/live/service/site/privacy.h"
#include "daemon/pipeline/record/recording_folder.h"
#include "daemon/pipeline/record/system_now.h"
#include "daemon/site/model/room_match.h"

namespace rayloc {
namespace {

constexpr std::size_t kPlayedFrames = 512;         // waiting, of a source that the user can seek
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

// Empty if no folder is given.
std::filesystem::path state_folder(const SiteSetup& setup) {
  const char* const state = std::getenv("STATE_DIRECTORY");  // systemd.exec(5)
  if (state == nullptr) {
    return {};
  }
  return setup.folder.empty() ? std::filesystem::path(state)
                              : std::filesystem::path(state) / setup.folder;
}

std::filesystem::path snapshot_folder(const SiteSetup& setup) {
  const RecordConfig& config = setup.config.record;
  return !config.snapshot_directory.empty() ? config.snapshot_directory
         : !config.directory.empty()        ? config.directory
                                            : state_folder(setup);
}

// With several sites, each has folders below the configured ones. Errors are reported by the code
// that writes there.
void make_folders(const SiteSetup& setup) {
  if (setup.folder.empty()) {
    return;
  }
  for (const std::filesystem::path& folder :
       {setup.config.record.directory, snapshot_folder(setup), state_folder(setup)}) {
    std::error_code ignored;
    if (!folder.empty()) {
      std::filesystem::create_directory(folder, ignored);
    }
  }
}

std::unique_ptr<RecorderStage> open_recorder(const RecordConfig& config,
                                             const std::string& access_point,
                                             SharedThreads& threads) {
  RotatingRecorderOptions options;
  options.folder = config.directory;
  options.name = access_point;
  options.limits = recording_limits(config);
  return std::make_unique<RecorderStage>(std::make_unique<RotatingRecorder>(std::move(options)),
                                         &threads.recorders);
}

PipelineOptions pipeline_options(const DaemonConfig& config, bool playback) {
  PipelineOptions options;
  options.burst.length = config.engine.burst;
  options.burst.max_transmitters = config.limits.max_targets;
  options.ring_frames = config.limits.ring_frames;
  // Recordings wait for the estimator, and so do streams: all workers must have equal results.
  if (std::none_of(config.sources.begin(), config.sources.end(), is_live) ||
      config.cluster.role == ClusterRole::kWorker) {
    options.overflow = Overflow::kWait;
  }
  if (playback) {  // the display follows it closely
    options.ring_frames = std::min(options.ring_frames, kPlayedFrames);
  }
  return options;
}

}  // namespace

SiteRuntime::SiteRuntime(SiteSetup setup, const Surroundings& surroundings)
    : setup_(std::move(setup)),
      surroundings_(surroundings),
      losses_(surroundings.limited_log, setup_.label()) {
  status_.started = surroundings_.started;
  status_.georeference = setup_.site.georeference;
}

// At any stage of a start, every thread ends before the objects that it uses.
SiteRuntime::~SiteRuntime() { end(); }

void SiteRuntime::end() {
  if (feed_) {
    feed_->finish();
  }
  if (pipeline_) {
    pipeline_->cancel_pending();
    pipeline_->stop();
  }
  if (estimators_) {
    estimators_->stop_compared();
  }
}

Expected<std::unique_ptr<SiteRuntime>> SiteRuntime::prepare(SiteSetup setup,
                                                            const Surroundings& surroundings) {
  std::unique_ptr<SiteRuntime> runtime(new SiteRuntime(std::move(setup), surroundings));
  surroundings.log("preparing the room of site '" + runtime->setup_.site.name + "'");
  RAYLOC_TRY(runtime->open_estimators());
  runtime->describe_room();
  runtime->check_site();
  return runtime;
}

Expected<void> SiteRuntime::open_estimators() {
  make_folders(setup_);
  auto names = open_target_names(setup_.config);
  RAYLOC_TRY(names);
  names_ = std::move(*names);
  SiteEstimators::Options options{surroundings_.path_grids, names_, {}};
  // A worker uses the state of the stream alone: other workers must compute the same.
  if (const auto folder = state_folder(setup_);
      !folder.empty() && setup_.config.cluster.role != ClusterRole::kWorker) {
    options.chain_file = (folder / kChainFile).string();
  }
  auto estimators = SiteEstimators::create(setup_, std::move(options));
  RAYLOC_TRY(estimators);
  estimators_ = std::move(*estimators);
  return {};
}

void SiteRuntime::describe_room() {
  status_.people = estimators_->people();
  status_.estimator = estimators_->devices();
  for (const auto& compared : estimators_->compared()) {
    status_.compared.push_back(compared.get());
  }
  if (room() == nullptr) {
    return;
  }
  status_.scene_hash = room()->scene_hash;
  status_.calibration_id = room()->calibration_id;
  for (const SceneNote& note : room()->scene->notes()) {
    surroundings_.log(setup_.label() + to_line(note));
  }
  for (const std::string& warning : room_warnings(*room()->scene, setup_.site)) {
    surroundings_.log(setup_.label() + warning);
  }
}

// Reports deficiencies of the site at the start, and as long as it runs.
void SiteRuntime::check_site() {
  if (room() != nullptr) {
    lacks_ = lacks_of(setup_, *room());
  }
  for (const std::string& text : lacks_.all()) {
    log_event({LogLevel::kWarning, setup_.label() + text});
  }
  status_.warnings = [this] { return public_warnings(health()); };
}

SiteOutput::Options SiteRuntime::output_options(std::shared_ptr<MessageBoard> board) {
  SiteOutput::Options output;
  output.site = setup_.site.name;
  output.board = std::move(board);
  output.status = [this](Timestamp now) { return status(now); };
  const auto& sources = setup_.config.sources;
  if (std::any_of(sources.begin(), sources.end(), is_live) &&
      setup_.config.cluster.role != ClusterRole::kWorker) {  // event time is that of capture nodes
    status_.clock = std::make_shared<ClockOffset>();
    output.clock_ahead = [clock = status_.clock] { return clock->now(); };
  }
  // Waiting frames may be published when this object no longer exists.
  output.name = [site = std::make_shared<const Site>(setup_.site), names = names_](
                    const CsiFrame& frame) { return transmitter_name(*site, frame, *names); };
  return output;
}

Expected<void> SiteRuntime::open(const Opened& before, SiteOutput& output) {
  const RecordConfig& record = setup_.config.record;
  const auto& log = surroundings_.log;
  if (const auto snapshots = snapshot_folder(setup_);
      !snapshots.empty() && snapshots != record.directory) {
    repair_recordings(snapshots, status_.started, log);
  }
  if (!record.directory.empty()) {
    status_.recordings_repaired = repair_recordings(record.directory, status_.started, log);
  }
  status_.output = &output;
  std::vector<SourceWorker::Input> inputs;
  RAYLOC_TRY(open_sources(before, output, inputs));
  const bool playback = recording_clock_.playback != nullptr;
  PipelineOptions options = pipeline_options(setup_.config, playback);
  options.threads = surroundings_.threads;
  LocationSink& sink = results_ ? go_on(options) : output;
  pipeline_ =
      std::make_unique<Pipeline>(options, std::move(inputs), estimators_->estimator(), sink);
  status_.pipeline = pipeline_.get();
  for (const auto& compared : estimators_->compared()) {
    compared->start(
        [&output](Location&& location) { return output.compared(std::move(location)); });
  }
  return sender_ ? sender_->start() : Expected<void>();
}

Expected<void> SiteRuntime::open_sources(const Opened& before,
                                         SiteOutput& output,
                                         std::vector<SourceWorker::Input>& inputs) {
  const DaemonConfig& config = setup_.config;
  auto clock = recording_clock(config);
  RAYLOC_TRY(clock);
  recording_clock_ = std::move(*clock);
  RAYLOC_TRY(open_cluster(output));
  status_.playback = recording_clock_.playback;
  const Method* const method = config.engine.method;
  for (const SourceConfig& source : config.sources) {
    std::unique_ptr<DatagramSource> known = before.take_source(source);
    const std::optional<int> socket = !known && takes_socket(source)
                                          ? before.take_socket("source-" + source.instance)
                                          : std::nullopt;
    Expected<SourceWorker::Input> input =
        known   ? source_input(source, setup_.site, method, std::move(known))
        : feed_ ? source_input(source, setup_.site, method, feed_->source(inputs.size()))
                : open_source(source, setup_.site, method, socket, recording_clock_);
    RAYLOC_TRY(input);
    if (!config.record.directory.empty()) {
      recorders_.push_back(
          open_recorder(config.record, source.access_point, *surroundings_.threads));
      input->taps.push_back(recorders_.back().get());
      status_.recorders.push_back(recorders_.back().get());
    }
    add_ring(*input);
    if (sender_) {
      input->taps.push_back(&sender_->tap(source.access_point));
    }
    FrameTap& frames = later_frames_ ? static_cast<FrameTap&>(*later_frames_) : output;
    input->frame_tap = config.publish.csi ? &frames : nullptr;
    status_.sources.push_back({is_live(source), source.stall_after});
    inputs.push_back(std::move(*input));
  }
  open_snapshots();
  return {};
}

void SiteRuntime::start() {
  if (feed_) {
    feed_->start();
  }
  if (feed_ && !along_) {
    results_->start();
  }
  pipeline_->start();
}

// Keeps recent datagrams of a source in memory, if there is a folder to write them to.
void SiteRuntime::add_ring(SourceWorker::Input& input) {
  const RecordConfig& config = setup_.config.record;
  if (config.ring <= Duration::zero() || snapshot_folder(setup_).empty()) {
    return;
  }
  rings_.push_back(std::make_unique<DatagramRing>(config.ring, config.ring_bytes));
  input.taps.push_back(rings_.back().get());
}

void SiteRuntime::open_snapshots() {
  std::vector<RingSnapshots::Source> sources;
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    sources.push_back({setup_.config.sources[i].access_point, rings_[i].get()});
  }
  const RecordConfig& config = setup_.config.record;
  if (!sources.empty()) {
    snapshots_of_rings_ = std::make_unique<RingSnapshots>(
        std::move(sources), snapshot_folder(setup_), snapshot_limits(config));
    status_.ring_snapshots = snapshots_of_rings_.get();
  }
}

Expected<std::vector<std::string>> SiteRuntime::snapshot() {
  if (!snapshots_of_rings_) {
    return make_error(ErrorKind::kUnavailable,
                      "nothing is kept for a snapshot; set snapshot_directory, and ring_s above 0, "
                      "in [record]");
  }
  return snapshots_of_rings_->request();
}

std::vector<std::string> SiteRuntime::notices() {
  auto lines = snapshots_of_rings_ ? snapshots_of_rings_->notices() : std::vector<std::string>();
  if (estimator() != nullptr) {
    const auto chains = estimator()->chain_notices();
    lines.insert(lines.end(), chains.begin(), chains.end());
  }
  if (estimators_->people() != nullptr) {
    const auto chains = estimators_->people()->chain_notices();
    lines.insert(lines.end(), chains.begin(), chains.end());
  }
  if (results_) {
    const auto left_out = results_->notices();
    lines.insert(lines.end(), left_out.begin(), left_out.end());
  }
  return lines;
}

void SiteRuntime::apply(const RecordConfig& record) {
  for (const auto& recorder : recorders_) {
    recorder->set_limits(recording_limits(record));
  }
  if (snapshots_of_rings_) {
    snapshots_of_rings_->set_limits(snapshot_limits(record));
  }
}

std::vector<Stage> SiteRuntime::stages() const {
  std::vector<Stage> stages = pipeline_->stages();
  for (std::size_t i = 0; i < recorders_.size(); ++i) {
    stages.push_back({"recorder " + setup_.config.sources[i].access_point,
                      &recorders_[i]->progress(),
                      recorders_[i]->has_shared_thread()});
  }
  if (sender_) {
    stages.push_back({"batches", &sender_->progress()});
  }
  if (feed_) {
    stages.push_back({"stream", &feed_->progress()});
    if (!results_->standby()) {  // a standby has no thread that publishes
      stages.push_back({"results", &results_->progress()});
    }
  }
  for (Stage& stage : stages) {  // a stuck stage is reported with its site
    stage.name = setup_.label() + stage.name;
  }
  return stages;
}

std::vector<SiteRuntime::Closing> SiteRuntime::closings() {
  std::vector<Closing> closings;
  for (const auto& compared : estimators_->compared()) {
    closings.push_back({"method " + compared->name(), [one = compared.get()] { one->stop(); }});
  }
  for (std::size_t i = 0; i < recorders_.size(); ++i) {
    closings.push_back({"recorder " + setup_.config.sources[i].access_point,
                        [recorder = recorders_[i].get()] { recorder->finish(); }});
  }
  if (snapshots_of_rings_) {
    closings.push_back({"ring snapshots", [this] { snapshots_of_rings_->finish(); }});
  }
  if (sender_) {
    closings.push_back({"batches", [this] { sender_->finish(); }});
  }
  if (feed_) {
    closings.push_back({"stream", [this] { feed_->finish(); }});
  }
  return closings;
}

std::string SiteRuntime::stuck_in_pipeline() const {
  std::vector<Stage> stages = pipeline_->stages();
  if (results_) {  // before its end, the site is given back
    stages.push_back({"results", &results_->progress()});
  }
  std::string names;
  for (const Stage& stage : stages) {
    if (stage.progress->started() && !stage.progress->resting()) {
      names += (names.empty() ? "" : ", ") + stage.name;
    }
  }
  return names.empty() ? "pipeline, which waits for a shared thread" : names;
}

std::vector<std::string> SiteRuntime::source_descriptions() const {
  std::vector<std::string> lines;
  for (const SourceReport& report : pipeline_->source_reports()) {
    lines.push_back(setup_.label() + report.access_point + ": " + report.description);
  }
  return lines;
}

std::vector<std::string> SiteRuntime::new_warnings() {
  const auto now = std::chrono::steady_clock::now();
  std::vector<std::string> fresh;
  if (estimator() == nullptr) {
    return fresh;
  }
  for (const CalibrationWarning& warning : estimator()->calibration_warnings()) {
    const auto reported = std::find_if(
        reported_warnings_.begin(), reported_warnings_.end(), [&](const ReportedWarning& one) {
          return one.warning.same_as(warning);
        });
    if (reported == reported_warnings_.end()) {
      reported_warnings_.push_back({warning, now});
    } else if (now - reported->time >= kRepeatWarning) {
      reported->time = now;
    } else {
      continue;
    }
    fresh.push_back(warning.text);
  }
  return fresh;
}

std::vector<std::string> SiteRuntime::errors() const {
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
  if (sender_) {
    if (const std::string trouble = sender_->trouble(); !trouble.empty()) {
      errors.push_back("cluster: " + trouble + "; received datagrams are still recorded");
    }
  }
  return errors;
}

StatusMessages SiteRuntime::status(Timestamp now) const {
  StatusMessages messages = status_messages(status_, now);
  if (sender_) {
    fill_capture(*sender_, *messages.heartbeat.mutable_capture());
  }
  if (feed_) {
    fill_feed(*feed_, *messages.heartbeat.mutable_stream());
  }
  return messages;
}

void SiteRuntime::check_losses() {
  const v1::Heartbeat heartbeat = status(system_now()).heartbeat;
  losses_.check(heartbeat);
  const std::lock_guard lock(saturation_mutex_);
  saturation_.check(heartbeat, std::chrono::steady_clock::now());
  if (saturation_.has_recovered()) {
    log_event({LogLevel::kInfo, setup_.label() + "the overload is over: all bursts are explained"});
  }
}

ServiceHealth SiteRuntime::health() const {
  ServiceHealth health;
  health.lacks = lacks_;
  for (const auto& recorder : recorders_) {
    if (std::string error = recorder->counters().files.error; !error.empty()) {
      health.recording_errors.push_back(std::move(error));
    }
  }
  const std::lock_guard lock(saturation_mutex_);
  health.saturated = saturation_.reasons();
  health.overloaded = saturation_.warnings();
  return health;
}

}  // namespace rayloc
