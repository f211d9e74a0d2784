// The part of Process that makes it a worker of a cluster: its sites are kept ready, and run while
// it owns them.
#include <algorithm>
#include <utility>

#include "daemon/live/cluster/ownership/owner_log.h"
#include "daemon/live/log/log.h"
#include "daemon/live/service/cluster_options.h"
#include "daemon/live/service/process.h"

namespace rayloc {
namespace {

// Period of the main thread: its contribution to a take-over.
constexpr std::chrono::milliseconds kTendWorker{50};
constexpr std::chrono::milliseconds kTend{1000};
constexpr double kPermille = 1e-3;

}  // namespace

std::chrono::milliseconds Process::tend_period() const { return claims_ ? kTendWorker : kTend; }

Expected<void> Process::open_claims() {
  const ClusterConfig& config = setup_.config.cluster;
  ClaimKeeper::Options options;
  options.worker = config.name;
  options.incarnation = random_epoch();
  options.lease = config.lease;
  options.capacity = config.capacity;
  options.all_sites = setup_.sites.size();
  options.stream = claim_stream(result_options(config));
  options.result_age = result_options(config).max_age;
  auto claims = ClaimKeeper::open(broker_, std::move(options));
  RAYLOC_TRY(claims);
  claims_ = std::move(*claims);
  return {};
}

// Keeps a site that is not owned ready: everything is prepared that is possible before.
void Process::keep_ready(SitePreparation::Prepared prepared) {
  const std::string name = prepared.name;
  stages_changed_ = true;
  if (!prepared.runtime) {
    sites_.put_absent(name, prepared.trouble);
    log_line(LogLevel::kError, "site '" + name + "' cannot be prepared: " + prepared.trouble);
    return;
  }
  if (along_.count(name) != 0) {
    end_standby(name, "it was prepared anew");
    std::erase_if(to_prepare_, [&](const SiteSetup& one) { return one.site.name == name; });
  }
  sites_.put_absent(name, "this worker does not own it");
  standby_[name] = std::move(prepared);
  audits_.add(name);
  claims_->offer(name);
}

void Process::tend_claims() {
  if (std::string trouble = claims_->trouble(); trouble != claim_trouble_) {
    claim_trouble_ = std::move(trouble);
    log_line(claim_trouble_.empty() ? LogLevel::kInfo : LogLevel::kError,
             claim_trouble_.empty() ? "sites are claimed again" : claim_trouble_);
  }
  for (const ClaimKeeper::Change& change : claims_->take_changes()) {
    if (change.generation > 0) {
      own(change);
    } else if (const SiteSet::Site site = sites_.find(change.site)) {
      lose(site, "worker '" + change.owner + "' has it");
    }
  }
  for (const SiteSet::Site& site : sites_.all()) {
    if (claims_->is_leaving()) {
      lose(site, "this worker was asked to give its sites back");
    } else if (const std::string why = site->runtime->lost(); !why.empty()) {
      lose(site, why);
    }
  }
  v1::WorkerState condition;
  if (setup_.config.cluster.is_hot) {
    tend_standby(condition);
  }
  tend_load(condition);
  claims_->set_condition(condition);
  if (!preparation_ && !to_prepare_.empty()) {
    preparation_ = std::make_unique<SitePreparation>(
        std::exchange(to_prepare_, {}),
        surroundings([](const std::string& line) { log_line(LogLevel::kInfo, line); }));
  }
}

void Process::tend_load(v1::WorkerState& condition) {
  std::map<std::string, std::uint32_t> levels;
  for (const SiteSet::Site& site : sites_.all()) {
    const std::uint32_t level = site->runtime->shed_level();
    levels[site->name()] = level;
    condition.set_shedding(condition.shedding() + (level > 0 ? 1 : 0));
  }
  const double load = load_.measure();
  condition.set_load_permille(static_cast<std::uint32_t>(load / kPermille));
  const auto offered =
      overload_.site_to_offer(levels, load, claims_->calmest(), std::chrono::steady_clock::now());
  if (!offered || claims_->is_leaving()) {
    return;
  }
  lose(sites_.find(*offered),
       "this worker has been too slow for it for long, and another one has room");
}

void Process::own(const ClaimKeeper::Change& change) {
  if (along_.count(change.site) != 0) {
    if (const Expected<void> owned = promote(change.site, change.generation); !owned) {
      claims_->give_back(change.site, change.generation);
      end_standby(change.site, owned.error().message);
    }
    return;
  }
  const auto ready = standby_.find(change.site);
  if (ready == standby_.end()) {
    claims_->give_back(change.site, change.generation);
    return;
  }
  SitePreparation::Prepared prepared = std::move(ready->second);
  standby_.erase(ready);
  SiteSetup setup = prepared.runtime->setup();
  if (const Expected<void> begun = begin_owned(std::move(prepared), change.generation); !begun) {
    claims_->give_back(change.site, change.generation);
    sites_.put_absent(change.site, begun.error().message);
    to_prepare_.push_back(std::move(setup));
    log_line(LogLevel::kError,
             "site '" + change.site + "' is given back: " + begun.error().message);
  }
}

Expected<void> Process::begin_owned(SitePreparation::Prepared prepared, std::uint64_t generation) {
  RAYLOC_TRY(prepared.runtime->claim(generation));
  auto begun = begin_site(std::move(prepared.runtime), std::move(prepared.files));
  RAYLOC_TRY(begun);
  show(std::move(*begun));
  sites_.find(prepared.name)->runtime->start();
  log_line(LogLevel::kInfo,
           "site '" + prepared.name + "' is owned, generation " + std::to_string(generation));
  return {};
}

// Publishes a site that is owned from now on.
void Process::show(RunningSite site) {
  const std::shared_ptr<SiteOutput> output = site.output;
  sites_.put(std::move(site));
  if (http_) {  // clients that receive the start of a site request its map
    http_->set_routes(routes());
  }
  publisher_->add(output);
  stages_changed_ = true;
}

// It is prepared anew: a pipeline with another start must not use the state of this one.
void Process::lose(const SiteSet::Site& site, const std::string& why) {
  const std::string name = site->name();
  end_sites({site});
  claims_->give_back(name, site->runtime->generation());
  handed_.close_others(name, {});
  publisher_->remove(site->output, "another worker goes on");
  sites_.remove(name);
  sites_.put_absent(name, why);
  stages_changed_ = true;
  if (!claims_->is_leaving()) {
    to_prepare_.push_back(site->runtime->setup());
  }
  log_line(LogLevel::kWarning, "site '" + name + "' is not owned any more: " + why);
}

// A worker gives its site back before the pipeline ends: the next owner need not wait for that, and
// results at an end differ from results in the middle.
void Process::end_pipeline(const SiteSet::Site& site) {
  site->runtime->give_back();
  if (claims_) {
    claims_->give_back(site->name(), site->runtime->generation());
  }
  site->runtime->pipeline().stop();
}

// Changed sites are given back and prepared anew; any worker may then claim them.
void Process::reload_worker(std::vector<SiteSetup> setups, const std::set<std::string>& changed) {
  std::set<std::string> stay;
  for (const SiteSetup& setup : setups) {
    stay.insert(setup.site.name);
  }
  const auto let_go_of = [&](const std::string& name, const std::string& why) {
    claims_->withdraw(name);
    standby_.erase(name);
    if (along_.count(name) != 0) {
      end_standby(name, why);
      std::erase_if(to_prepare_, [&](const SiteSetup& one) { return one.site.name == name; });
    }
    if (const SiteSet::Site running = sites_.find(name)) {
      lose(running, why);
      std::erase_if(to_prepare_, [&](const SiteSetup& one) { return one.site.name == name; });
    }
  };
  std::set<std::string> known;
  for (const SiteSet::Site& site : sites_.all()) {
    known.insert(site->name());
  }
  for (const auto& [name, why] : sites_.absent()) {
    known.insert(name);
  }
  for (const std::string& name : known) {
    if (stay.count(name) == 0) {
      let_go_of(name, "the site is no longer configured");
      sites_.remove(name);
      along_not_before_.erase(name);
      audits_.remove(name);
      stages_changed_ = true;
    }
  }
  for (SiteSetup& setup : setups) {
    const std::string& name = setup.site.name;
    const SiteSet::Site running = sites_.find(name);
    const auto ready = standby_.find(name);
    const auto along = along_.find(name);
    const InputFiles* const files = running                   ? &running->files
                                    : along != along_.end()   ? &along->second->files
                                    : ready != standby_.end() ? &ready->second.files
                                                              : nullptr;
    if (!setup.trouble.empty()) {
      log_line(LogLevel::kError, "reload: site '" + name + "' is left as it was: " + setup.trouble);
    } else if (files == nullptr || changed.count(name) != 0 ||
               !files->changes_to(InputFiles::of(setup)).empty()) {
      let_go_of(name, "its configuration is another");
      sites_.put_absent(name, "it is being prepared");
      to_prepare_.push_back(std::move(setup));
    }
  }
}

}  // namespace rayloc
