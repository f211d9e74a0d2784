#include "daemon/live/cluster/cluster_view.h"

#include <algorithm>
#include <mutex>
#include <thread>
#include <utility>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/operate/stream_admin.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/pipeline/record/system_now.h"

namespace rayloc {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kViewPollInterval{20};
constexpr milliseconds kUsualLease{2000};  // the preset, used when none is stated

// Each claim is the last message of its subject.
Expected<void> read_claims(Broker& broker, ClusterView& view) {
  const std::string stream(kClaimStream);
  const auto subjects = subjects_of(broker, stream);
  RAYLOC_TRY(subjects);
  for (const std::string& subject : *subjects) {
    const auto message = broker.last_of(stream, subject);
    RAYLOC_TRY(message);
    v1::SiteClaim claim;
    if (*message && unseal((*message)->data, claim) && !claim.removed()) {
      view.sites[token_name(last_token(subject))].claim = std::move(claim);
    }
  }
  return {};
}

Expected<void> read_last_results(Broker& broker, ClusterView& view) {
  for (auto& [name, site] : view.sites) {
    const auto last = broker.last_of(std::string(kOutputStream), output_subject(name));
    RAYLOC_TRY(last);
    if (*last && !unseal((*last)->data, site.last)) {
      site.last.Clear();
    }
  }
  return {};
}

// Returns the longest stated lease.
milliseconds lease_of(const ClusterView& view) {
  std::uint32_t longest = 0;
  for (const auto& [name, site] : view.sites) {
    longest = std::max(longest, site.claim.lease_ms());
  }
  for (const auto& [name, worker] : view.workers) {
    longest = std::max(longest, worker.state.lease_ms());
  }
  return longest > 0 ? milliseconds(longest) : kUsualLease;
}

bool all_owners_report(const ClusterView& view) {
  return std::all_of(view.sites.begin(), view.sites.end(), [&](const auto& site) {
    return site.second.claim.worker().empty() || view.has_owner(site.second.claim);
  });
}

}  // namespace

bool ClusterView::has_owner(const v1::SiteClaim& claim) const {
  const auto worker = workers.find(claim.worker());
  return worker != workers.end() && worker->second.state.incarnation() == claim.incarnation();
}

std::size_t ClusterView::sites_without_owner() const {
  return static_cast<std::size_t>(std::count_if(
      sites.begin(), sites.end(), [&](const auto& site) { return !has_owner(site.second.claim); }));
}

bool wait_for_broker(const Broker& broker, milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!broker.connected() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(kViewPollInterval);
  }
  return broker.connected();
}

Expected<ClusterView> inspect_cluster(Broker& broker) {
  ClusterView view;
  std::map<std::string, ClusterView::Worker> received;
  std::mutex mutex;
  auto states = broker.subscribe(std::string(kWorkerSubjects), [&](const BrokerMessage& message) {
    v1::WorkerState state;
    if (unseal(message.data, state)) {
      const std::lock_guard lock(mutex);
      ClusterView::Worker& worker = received[state.worker()];
      worker = {std::move(state), system_now()};
    }
  });
  RAYLOC_TRY(states);
  const auto begin = std::chrono::steady_clock::now();
  RAYLOC_TRY(read_claims(broker, view));
  for (bool enough = false; !enough;) {
    std::this_thread::sleep_for(kViewPollInterval);
    {
      const std::lock_guard lock(mutex);
      view.workers = received;
    }
    const milliseconds lease = lease_of(view);
    const auto passed = std::chrono::steady_clock::now() - begin;
    enough = passed >= lease || (passed >= lease / 2 && all_owners_report(view));
  }
  states->reset();
  RAYLOC_TRY(read_last_results(broker, view));
  return view;
}

}  // namespace rayloc
