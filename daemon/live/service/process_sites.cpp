// The part of Process that starts and ends sites, at the start and by a reload.
#include <fcntl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "daemon/live/log/log.h"
#include "daemon/live/service/process.h"
#include "daemon/pipeline/record/system_now.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr std::size_t kSubjectsShown = 2048;  // on the map of a site
// Maximum time that the end of one site may block the main thread: to drain, and then to leave.
constexpr auto kDrain = std::chrono::milliseconds(500);
constexpr auto kLeave = std::chrono::milliseconds(3000);
constexpr const char* kPipelineStep = "pipeline";

// Where devices are named by a hash for a limited time, their positions are deleted with it.
Duration presence_kept(const PrivacyConfig& privacy) {
  const Duration day = std::chrono::hours(24);
  return privacy.target_id == TargetId::kHmac ? std::min(day, privacy.rotate) : day;
}

// Frames that were not processed.
struct FrameCount {
  std::uint64_t waiting = 0;
  std::uint64_t dropped = 0;
};

// Losses of all exchanges of a site; empty without losses.
std::string cost(const v1::ReloadCounters& reloads) {
  if (reloads.datagrams_lost() == 0 && reloads.frames_left() == 0) {
    return "";
  }
  return fmt::format("; since the start {} exchanges have lost {} datagrams and left {} frames",
                     reloads.exchanges(),
                     reloads.datagrams_lost(),
                     reloads.frames_left());
}

FrameCount count_frames(const SiteRuntime& runtime) {
  const v1::Heartbeat heartbeat = runtime.status(system_now()).heartbeat;
  FrameCount frames{heartbeat.estimation().frames_in_flight(),
                    heartbeat.estimation().frames_dropped()};
  for (const v1::SourceReport& source : heartbeat.sources()) {
    frames.waiting += source.counters().frames_in_flight();
    frames.dropped += source.counters().frames_dropped();
  }
  return frames;
}

}  // namespace

SiteRuntime::Surroundings Process::surroundings(
    const std::function<void(const std::string&)>& log) const {
  SiteRuntime::Surroundings surroundings;
  surroundings.started = system_now();
  surroundings.path_grids = path_grids_;
  surroundings.limited_log = limited_log_;
  surroundings.threads = shared_threads_;
  surroundings.capture = capture_.get();
  surroundings.broker = broker_;
  surroundings.log = log;
  return surroundings;
}

void Process::fill_shared(StatusSources& status) const {
  status.epoch = epoch_;
  status.snapshots = snapshots_.get();
  status.http = http_.get();
}

v1::Heartbeat Process::shared() const {
  StatusSources sources;
  fill_shared(sources);
  return shared_counters(publisher_->published(), sources);
}

// systemd passes a socket once. With several sites, one may need it again.
std::optional<int> Process::passed_socket(const std::string& name) {
  if (sockets_ != nullptr) {
    const std::optional<int> passed = sockets_->take(name);
    if (!passed || !has_site_list_) {
      return passed;
    }
    passed_.try_emplace(name, *passed);
  }
  const auto kept = passed_.find(name);
  return kept == passed_.end() ? std::nullopt
                               : std::optional(fcntl(kept->second.get(), F_DUPFD_CLOEXEC, 0));
}

Expected<RunningSite> Process::begin_site(std::unique_ptr<SiteRuntime> runtime, InputFiles files) {
  RunningSite site;
  if (setup_.config.http.enabled) {
    const SiteSet::Site before = sites_.find(runtime->setup().site.name);
    site.board = before ? before->board
                        : std::make_shared<MessageBoard>(kSubjectsShown,
                                                         presence_kept(setup_.config.privacy));
  }
  fill_shared(runtime->status_sources());
  if (has_site_list_) {
    runtime->status_sources().reloads = reloads_[runtime->setup().site.name];
  }
  site.output = publisher_->make_output(runtime->output_options(site.board));
  site.runtime = std::move(runtime);
  site.files = std::move(files);
  const Expected<void> opened =
      site.runtime->open({[this](const std::string& name) { return passed_socket(name); },
                          [this](const SourceConfig& source) { return handed_.take(source); }},
                         *site.output);
  RAYLOC_TRY(opened);
  if (gateway_) {
    listen_to_owner(site.runtime->setup().site.name, site.output);
  }
  open_api(site);
  return site;
}

std::vector<Process::Ending> Process::end_in_parallel(const std::vector<SiteSet::Site>& sites,
                                                      const Deadlines& until) {
  std::vector<Ending> endings;
  endings.reserve(sites.size());
  for (const SiteSet::Site& site : sites) {
    const Ending& one = endings.emplace_back(Ending{site, std::make_unique<Shutdown>()});
    one.steps->begin(kPipelineStep, [this, site] { end_pipeline(site); });
  }
  for (const Ending& one : endings) {
    if (!one.steps->wait_for(kPipelineStep, until.drained)) {
      one.site->runtime->pipeline().cancel_pending();
    }
  }
  for (const Ending& one : endings) {
    one.steps->wait_for(kPipelineStep, until.ended);
  }
  for (const Ending& one : endings) {
    for (SiteRuntime::Closing& closing : one.site->runtime->closings()) {
      one.steps->run(closing.stage, until.closed, std::move(closing.finish));
    }
  }
  return endings;
}

// Names of the stages that have not returned by now, with their site. Logs the steps that failed.
std::vector<std::string> Process::stuck_stages(Ending& ending) {
  std::vector<std::string> names;
  const bool all_returned = ending.steps->all_returned();
  for (const Shutdown::Failure& failure : ending.steps->take_failures()) {
    log_line(LogLevel::kError,
             fmt::format("the end of site '{}' failed: {}: {}",
                         ending.site->name(),
                         failure.step,
                         failure.reason));
    ending.has_failed = ending.has_failed || failure.step == kPipelineStep;
  }
  if (ending.has_failed) {
    names.push_back(ending.site->label() + kPipelineStep);
  }
  if (all_returned) {
    return names;
  }
  for (const std::string& step : ending.steps->hung()) {
    names.push_back(ending.site->label() +
                    (step == kPipelineStep ? ending.site->runtime->stuck_in_pipeline() : step));
  }
  return names;
}

// Ends their threads; the goodbye is left to the caller. Objects used by a stage that does not
// return are kept.
void Process::end_sites(const std::vector<SiteSet::Site>& sites) {
  const Shutdown::Time begin = std::chrono::steady_clock::now();
  for (Ending& ending : end_in_parallel(sites, {begin + kDrain, begin + kLeave, begin + kLeave})) {
    const std::vector<std::string> stuck = stuck_stages(ending);
    for (const std::string& stage : stuck) {
      log_line(LogLevel::kError, stage + " does not come back, and is left behind");
    }
    if (stuck.empty()) {
      let_go(ending.site);
    } else {
      abandoned_.push_back(std::move(ending));
      stages_changed_ = true;
    }
  }
}

// Closes their sources: no successor is waiting for them, and the next one needs their ports.
void Process::release_abandoned() {
  for (auto one = abandoned_.begin(); one != abandoned_.end();) {
    if (!stuck_stages(*one).empty()) {
      ++one;
      continue;
    }
    const std::string& name = one->site->name();
    let_go(one->site);
    const std::uint64_t lost = handed_.close_others(name, {});
    if (const auto reloads = reloads_.find(name); reloads != reloads_.end()) {
      reloads->second.set_datagrams_lost(reloads->second.datagrams_lost() + lost);
    }
    log_line(
        LogLevel::kInfo,
        fmt::format(
            "site '{}' that was left behind has ended; {} waiting datagrams are lost", name, lost));
    stages_changed_ = true;
    one = abandoned_.erase(one);
  }
}

// Takes over the remaining objects of a site that has ended.
void Process::let_go(const SiteSet::Site& site) {
  if (site->channel) {
    ended_channels_.push_back(site->channel);
  }
  const std::vector<SourceConfig>& configs = site->runtime->setup().config.sources;
  auto sources = site->runtime->pipeline().release_sources();
  for (std::size_t i = 0; i < sources.size(); ++i) {
    handed_.add(configs[i], std::move(sources[i]));
  }
}

RunningSetup Process::running() const {
  RunningSetup running{setup_.config, {}};
  for (const SiteSet::Site& site : sites_.all()) {
    running.names[site->runtime->setup().directory] = site->name();
  }
  for (const auto& [name, ready] : standby_) {
    running.names[ready.runtime->setup().directory] = name;
  }
  for (const auto& [name, site] : along_) {
    running.names[site->runtime->setup().directory] = name;
  }
  return running;
}

void Process::note_trouble(const std::string& name, const std::string& trouble, AfterReload state) {
  if (const SiteSet::Site running = sites_.find(name)) {
    RunningSite same = *running;
    same.trouble = trouble;
    same.has_ended = same.has_ended || state == AfterReload::kEnded;
    sites_.put(std::move(same));
  } else {
    sites_.put_absent(name, trouble);
    state = AfterReload::kAbsent;
  }
  stages_changed_ = true;
  constexpr std::array kStateTexts = {"is left as it was",
                                      "has ended and does not begin, reload again",
                                      "does not begin, reload again"};
  log_line(LogLevel::kError,
           "reload: site '" + name + "' " + kStateTexts.at(static_cast<std::size_t>(state)) + ": " +
               trouble);
}

void Process::reload_sites(std::vector<SiteSetup> setups, const std::set<std::string>& changed) {
  if (!has_site_list_ || !setups.front().config.has_site_list) {
    return;  // reported as a change that needs a restart
  }
  if (claims_) {
    reload_worker(std::move(setups), changed);
    return;
  }
  const auto stays = [&](const std::string& name) {
    return std::any_of(setups.begin(), setups.end(), [&](const SiteSetup& setup) {
      return setup.site.name == name;
    });
  };
  for (const auto& [name, why] : sites_.absent()) {
    if (!stays(name)) {
      sites_.remove(name);
      stages_changed_ = true;
    }
  }
  std::vector<SiteSet::Site> leaving = sites_.all();
  std::erase_if(leaving, [&](const SiteSet::Site& site) { return stays(site->name()); });
  std::vector<SiteSet::Site> to_end = leaving;
  // The last exchange has ended those already, or still waits for their stages.
  std::erase_if(to_end, [](const SiteSet::Site& site) { return site->has_ended; });
  end_sites(to_end);
  for (const SiteSet::Site& site : leaving) {
    handed_.close_others(site->name(), {});
    if (gateway_) {
      gateway_->remove(site->name());
    }
    if (capture_) {
      capture_->remove_site(site->name());
    }
    publisher_->remove(site->output, "the site is no longer configured");
    reloads_.erase(site->name());
    sites_.remove(site->name());
    stages_changed_ = true;
    log_line(LogLevel::kInfo, "site '" + site->name() + "' has ended");
  }
  std::vector<SiteSetup> begin;
  for (SiteSetup& setup : setups) {
    const std::string& name = setup.site.name;
    if (!setup.trouble.empty()) {
      note_trouble(name, setup.trouble, AfterReload::kAsItWas);
      continue;
    }
    const SiteSet::Site running = sites_.find(name);
    if (!running || !running->trouble.empty() || changed.count(name) != 0 ||
        !running->files.changes_to(InputFiles::of(setup)).empty()) {
      begin.push_back(std::move(setup));
    }
  }
  if (!begin.empty()) {
    preparation_ = std::make_unique<SitePreparation>(
        std::move(begin),
        surroundings([](const std::string& line) { log_line(LogLevel::kInfo, printable(line)); }));
  }
}

// All of them release their ports before the first is opened: they may have exchanged them.
void Process::end_for_exchange(const std::vector<SitePreparation::Prepared>& prepared) {
  struct Exchange {
    const SiteRuntime* next = nullptr;
    std::uint64_t dropped = 0;  // frames, before it ends
  };
  std::vector<SiteSet::Site> leaving;
  std::vector<Exchange> exchanges;
  for (const SitePreparation::Prepared& one : prepared) {
    const SiteSet::Site running = sites_.find(one.name);
    if (one.runtime && running && !running->has_ended) {
      running->runtime->pipeline().end_tracks("the site was prepared anew");
      leaving.push_back(running);
      exchanges.push_back({one.runtime.get(), count_frames(*running->runtime).dropped});
    }
  }
  end_sites(leaving);
  for (std::size_t i = 0; i < leaving.size(); ++i) {
    const RunningSite& site = *leaving[i];
    publisher_->remove(site.output, std::nullopt);
    const FrameCount frames = count_frames(*site.runtime);
    v1::ReloadCounters& reloads = reloads_[site.name()];
    reloads.set_exchanges(reloads.exchanges() + 1);
    reloads.set_datagrams_lost(
        reloads.datagrams_lost() +
        handed_.close_others(site.name(), exchanges[i].next->setup().config.sources));
    reloads.set_frames_left(reloads.frames_left() + frames.waiting + frames.dropped -
                            exchanges[i].dropped);
  }
}

void Process::exchange_sites(std::vector<SitePreparation::Prepared> prepared) {
  end_for_exchange(prepared);
  std::vector<SiteSet::Site> begun;
  for (SitePreparation::Prepared& one : prepared) {
    stages_changed_ = true;
    if (!one.runtime) {
      note_trouble(one.name, one.trouble, AfterReload::kAsItWas);
      continue;
    }
    auto site = begin_site(std::move(one.runtime), std::move(one.files));
    if (!site) {
      v1::ReloadCounters& reloads = reloads_[one.name];
      reloads.set_datagrams_lost(reloads.datagrams_lost() + handed_.close_others(one.name, {}));
      note_trouble(one.name, site.error().message, AfterReload::kEnded);
      continue;
    }
    sites_.put(std::move(*site));
    begun.push_back(sites_.find(one.name));
  }
  if (http_) {  // clients that receive the start of a site request its map
    http_->set_routes(routes());
  }
  for (const SiteSet::Site& site : begun) {
    publisher_->add(site->output);
    site->runtime->start();
    for (const std::string& line : site->runtime->source_descriptions()) {
      log_line(LogLevel::kInfo, "listening: " + line);
    }
    log_line(LogLevel::kInfo,
             "site '" + site->name() + "' runs, prepared anew" + cost(reloads_[site->name()]));
  }
}

bool Process::tend_sites() {
  if (preparation_ && preparation_->done()) {
    std::vector<SitePreparation::Prepared> prepared = preparation_->take();
    preparation_.reset();
    if (claims_) {
      for (SitePreparation::Prepared& one : prepared) {
        keep_ready(std::move(one));
      }
    } else {
      exchange_sites(std::move(prepared));
    }
  }
  if (claims_) {
    tend_claims();
  }
  release_abandoned();
  if (stages_changed_ && http_) {
    http_->set_routes(routes());
  }
  std::erase_if(ended_channels_, [](const std::shared_ptr<BackgroundText>& one) {
    return one.use_count() == 1 && one->idle();
  });
  return std::exchange(stages_changed_, false);
}

}  // namespace rayloc
