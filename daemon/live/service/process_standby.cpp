// The part of Process that makes a worker a hot standby: it computes the sites that it is next for
// in parallel, compares the results with their owners', and takes over immediately if one dies.
#include <algorithm>
#include <utility>

#include "daemon/live/log/log.h"
#include "daemon/live/service/process.h"

namespace rayloc {
namespace {

using std::chrono::seconds;

// Chosen: between checks of the sites that it is next for.
constexpr seconds kStandbyInterval{1};
// Chosen: between two tries for a site. Otherwise a site that cannot be followed would be started,
// with a room that is prepared, again and again.
constexpr seconds kTryAgain{60};
constexpr seconds kNotYet{5};  // chosen: the same, if the owner has not published yet

}  // namespace

void Process::tend_standby(v1::WorkerState& condition) {
  const SteadyTime now = std::chrono::steady_clock::now();
  std::map<std::string, std::string> troubles;
  for (const auto& [name, site] : along_) {
    note_audit(*site);
    const auto standby = site->runtime->standby();
    if (claims_->is_leaving()) {
      troubles[name] = "this worker takes no more sites";
    } else if (standby && !standby->trouble.empty()) {
      troubles[name] = standby->trouble;
    } else if (standby && standby->counters.windows > 0) {  // it has caught up
      v1::StandbyState& state = *condition.add_stands_by();
      state.set_site(name);
      state.set_windows(standby->counters.windows);
      state.set_results(standby->counters.results);
      state.set_differing(standby->counters.differing);
      state.set_is_late(site->runtime->is_late());
    }
  }
  for (const auto& [name, why] : troubles) {
    end_standby(name, why);
  }
  if (now - along_checked_ < kStandbyInterval || claims_->is_leaving()) {
    return;
  }
  along_checked_ = now;
  const std::size_t most = setup_.config.cluster.capacity;
  if (most > 0 && sites_.all().size() + along_.size() >= most) {
    return;
  }
  // One per call: other tasks wait for the main thread.
  const auto next = std::find_if(standby_.begin(), standby_.end(), [&](const auto& one) {
    return now >= along_not_before_[one.first] && claims_->is_next(one.first);
  });
  if (next != standby_.end()) {
    begin_standby(std::string(next->first));
  }
}

void Process::begin_standby(const std::string& name) {
  // Other sites have priority while this one cannot be followed yet.
  along_not_before_[name] = std::chrono::steady_clock::now() + kNotYet;
  auto along = standby_start(*broker_, name);
  if (!along) {
    return;  // no output to follow yet
  }
  const bool is_late = along->is_late;
  SiteSetup setup = standby_.at(name).runtime->setup();
  auto site = computing_along(std::move(standby_.extract(name).mapped()), *std::move(along));
  if (!site) {
    claims_->withdraw(name);
    along_not_before_[name] = std::chrono::steady_clock::now() + kTryAgain;
    to_prepare_.push_back(std::move(setup));
    log_line(LogLevel::kError,
             "site '" + name + "' cannot be computed along: " + site.error().message);
    return;
  }
  along_[name] = *std::move(site);
  stages_changed_ = true;
  sites_.put_absent(name, "another worker owns it; this one computes along, and is next");
  log_line(
      LogLevel::kInfo,
      "site '" + name + "' is computed along with its owner" +
          (is_late ? ", from a later start than the owner's: positions are not compared" : ""));
}

Expected<SiteSet::Site> Process::computing_along(SitePreparation::Prepared prepared,
                                                 StandbyStart along) {
  RAYLOC_TRY(prepared.runtime->begin_standby(std::move(along)));
  auto begun = begin_site(std::move(prepared.runtime), std::move(prepared.files));
  RAYLOC_TRY(begun);
  begun->runtime->start();
  return std::make_shared<const RunningSite>(*std::move(begun));
}

// It takes over immediately, without preparing a room or processing frames again.
Expected<void> Process::promote(const std::string& name, std::uint64_t generation) {
  const SiteSet::Site site = along_.at(name);
  note_audit(*site);
  const auto standby = site->runtime->standby();
  if (standby && !standby->trouble.empty()) {
    return make_error(ErrorKind::kUnavailable, standby->trouble);
  }
  RAYLOC_TRY(site->runtime->claim(generation));
  along_.erase(name);
  show(*site);
  note_audit(*site);  // with the comparisons made during the claim
  site->runtime->take_over();
  audits_.end(name);
  log_line(LogLevel::kInfo,
           "site '" + name + "' is owned, generation " + std::to_string(generation) +
               ", and goes on at once: it was computed along");
  return {};
}

// The site is prepared anew, because a fresh runtime must not use the state of the old one.
void Process::end_standby(const std::string& name, const std::string& why) {
  const SiteSet::Site site = along_.extract(name).mapped();
  stages_changed_ = true;
  note_audit(*site);
  claims_->withdraw(name);
  end_sites({site});
  handed_.close_others(name, {});
  sites_.put_absent(name, "this worker does not own it");
  along_not_before_[name] = std::chrono::steady_clock::now() + kTryAgain;
  if (!claims_->is_leaving()) {
    to_prepare_.push_back(site->runtime->setup());
  }
  audits_.end(name);
  log_line(LogLevel::kInfo, "site '" + name + "' is not computed along any more: " + why);
}

void Process::note_audit(const RunningSite& site) {
  if (const auto standby = site.runtime->standby()) {
    audits_.note(site.name(), *standby);
  }
}

std::vector<ExtraMetric> Process::standby_metrics() const {
  return setup_.config.cluster.is_hot && claims_ ? audits_.metrics() : std::vector<ExtraMetric>();
}

}  // namespace rayloc
