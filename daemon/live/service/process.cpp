#include "daemon/live/service/process.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "daemon/live/config/secrets.h"
#include "daemon/live/log/log.h"
#include "daemon/live/service/curve_access.h"
#include "daemon/live/service/passed_socket_check.h"
#include "daemon/live/service/place_check.h"
#include "daemon/pipeline/record/system_now.h"
#include "daemon/site/model/path_grid_files.h"

namespace rayloc {
namespace {

// Null if path grids are not to be stored, or no folder is given.
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

}  // namespace

Expected<std::unique_ptr<Process>> Process::open(
    DaemonSetup setup,
    PassedSockets& sockets,
    const std::function<void(const std::string& line)>& log) {
  std::unique_ptr<Process> process(new Process(std::move(setup)));
  const DaemonConfig& config = process->setup_.config;
  for (const Expected<void>& good : {check_secrets(config),
                                     check_passed_sockets(sockets, config),
                                     check_places(config, sockets),
                                     process->check_resources(false)}) {
    RAYLOC_TRY(good);
  }
  RAYLOC_TRY(process->open_cluster());
  process->sockets_ = &sockets;
  process->path_grids_ = path_grids(config.cache, log);
  std::vector<std::unique_ptr<SiteRuntime>> runtimes;
  for (const SiteSetup& one : process->setup_.sites) {
    auto runtime = SiteRuntime::prepare(one, process->surroundings(log));
    RAYLOC_TRY(runtime);
    runtimes.push_back(std::move(*runtime));
  }
  RAYLOC_TRY(process->open_publishing(sockets));
  for (std::unique_ptr<SiteRuntime>& runtime : runtimes) {
    InputFiles files = InputFiles::of(runtime->setup());
    if (process->claims_) {
      const std::string name = runtime->setup().site.name;
      process->keep_ready({name, std::move(files), std::move(runtime), ""});
      continue;
    }
    auto site = process->begin_site(std::move(runtime), std::move(files));
    RAYLOC_TRY(site);
    process->publisher_->add(site->output);
    process->sites_.put(std::move(*site));
  }
  RAYLOC_TRY(process->open_http(sockets));
  process->sockets_ = nullptr;
  return process;
}

Expected<void> Process::open_publishing(PassedSockets& sockets) {
  RAYLOC_TRY(check_resources(true));
  const DaemonConfig& config = setup_.config;
  auto guard = open_curve_access(config.curve, limited_log_, [this] { guard_progress_.beat(); });
  RAYLOC_TRY(guard);
  guard_ = std::move(*guard);
  PublisherOptions publishing;
  publishing.guard = guard_;
  publishing.endpoint = config.publish.endpoint;
  publishing.adopted_fd = sockets.take("publish").value_or(-1);
  publishing.site = setup_.sites.front().site.name;
  publishing.epoch = random_epoch();
  epoch_ = publishing.epoch;
  last_messages_ = std::make_shared<LastMessages>(publishing.max_topics);
  publishing.last = last_messages_;
  publishing.high_water_mark = static_cast<int>(config.publish.send_high_water_mark);
  Expected<Publisher> publisher = Publisher::bind(publishing);
  RAYLOC_TRY(publisher);
  SnapshotServer::Options snapshots;
  snapshots.endpoint = config.publish.snapshot;
  snapshots.adopted_fd = sockets.take("snapshot").value_or(-1);
  snapshots.epoch = publishing.epoch;
  snapshots.last = last_messages_;
  snapshots.guard = guard_;
  snapshots.on_round = [this] { snapshots_progress_.beat(); };
  auto snapshot_server = SnapshotServer::open(snapshots);
  RAYLOC_TRY(snapshot_server);
  snapshots_ = std::move(*snapshot_server);
  PublisherStage::Options stage;
  stage.heartbeat = config.publish.heartbeat;
  stage.now = system_now;
  publisher_ = std::make_unique<PublisherStage>(std::move(*publisher), std::move(stage));
  return {};
}

Expected<std::vector<std::string>> Process::snapshot() {
  std::vector<std::string> files;
  std::optional<Error> error;
  for (const SiteSet::Site& site : sites_.all()) {
    const Expected<std::vector<std::string>> some = site->runtime->snapshot();
    if (some) {
      files.insert(files.end(), some->begin(), some->end());
    } else if (!error) {
      error = some.error();
    }
  }
  if (files.empty() && error) {
    return tl::make_unexpected(std::move(*error));
  }
  return files;
}

namespace {

void add_labelled(const RunningSite& site,
                  const std::vector<std::string>& lines,
                  std::vector<std::string>& all) {
  for (const std::string& line : lines) {
    all.push_back(site.label() + line);
  }
}

}  // namespace

std::vector<std::string> Process::notices() {
  std::vector<std::string> lines;
  for (const SiteSet::Site& site : sites_.all()) {
    add_labelled(*site, site->runtime->notices(), lines);
  }
  return lines;
}

void Process::apply(const DaemonConfig& config) {
  publisher_->set_heartbeat(config.publish.heartbeat);
  for (const SiteSet::Site& site : sites_.all()) {
    site->runtime->apply(config.record);
  }
  guard_->allow(config.curve.allow);
}

std::string Process::status_line() const {
  std::uint64_t sources = 0;
  std::uint64_t received = 0;
  std::uint64_t kernel_drops = 0;
  std::uint64_t active = 0;
  std::uint64_t fixes = 0;
  const std::vector<SiteSet::Site> sites = sites_.all();
  for (const SiteSet::Site& site : sites) {
    for (const SourceReport& report : site->runtime->pipeline().source_reports()) {
      ++sources;
      received += report.source.received;
      kernel_drops += report.source.kernel_drops;
      active += report.source.delivered > 0 ? 1U : 0U;
    }
    const EstimationCounters estimation = site->runtime->pipeline().estimation_counters();
    fixes += estimation.snapshots - estimation.no_fix;
  }
  return fmt::format(
      "{} of {} sources receive; {} datagrams, {} dropped by the kernel; {} fixes{}{}",
      active,
      sources,
      received,
      kernel_drops,
      fixes,
      has_site_list_ ? fmt::format("; {} sites", sites.size()) : "",
      health_.reload_failed() ? "; the last reload failed" : "");
}

std::vector<std::string> Process::source_descriptions() const {
  std::vector<std::string> lines;
  for (const SiteSet::Site& site : sites_.all()) {
    const auto some = site->runtime->source_descriptions();
    lines.insert(lines.end(), some.begin(), some.end());
  }
  return lines;
}

std::vector<std::string> Process::new_warnings() {
  std::vector<std::string> lines;
  for (const SiteSet::Site& site : sites_.all()) {
    add_labelled(*site, site->runtime->new_warnings(), lines);
  }
  return lines;
}

void Process::log_losses() {
  for (const SiteSet::Site& site : sites_.all()) {
    site->runtime->check_losses();
  }
  shared_losses_.check_shared(shared(), log_entries_dropped());
  limited_log_->flush();
}

std::vector<std::string> Process::new_errors() {
  std::vector<std::string> errors;
  for (const SiteSet::Site& site : sites_.all()) {
    add_labelled(*site, site->runtime->errors(), errors);
  }
  check_broker();
  if (!broker_trouble_.empty()) {
    errors.push_back(broker_trouble_);
  }
  std::vector<std::string> fresh;
  const auto holds = [](const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
  };
  for (const std::string& error : errors) {
    if (!holds(reported_errors_, error) && !holds(fresh, error)) {
      fresh.push_back(error);
    }
  }
  for (const std::string& error : reported_errors_) {
    if (!holds(errors, error)) {
      ended_errors_.push_back(error);
    }
  }
  reported_errors_ = std::move(errors);
  return fresh;
}

std::vector<std::string> Process::ended_errors() { return std::exchange(ended_errors_, {}); }

}  // namespace rayloc
