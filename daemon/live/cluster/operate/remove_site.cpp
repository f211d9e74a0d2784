#include "daemon/live/cluster/operate/remove_site.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <thread>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/operate/site_bundle.h"
#include "daemon/live/cluster/operate/stream_admin.h"
#include "daemon/live/cluster/sealed_message.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {
namespace {

constexpr std::chrono::milliseconds kRemovalStep{200};
constexpr std::chrono::seconds kRemovalTimeout{30};  // fetching processes poll every 10 seconds

// Returns true if the site had been applied.
Expected<bool> retract(Broker& broker, const std::string& site) {
  const auto bundles = stored_bundles(broker);
  RAYLOC_TRY(bundles);
  const auto bundle = bundles->find(site);
  if (bundle == bundles->end() || bundle->second.empty()) {
    return false;
  }
  const Expected<void> retracted = retract_bundle(broker, site);
  return retracted ? Expected<bool>(true) : tl::make_unexpected(retracted.error());
}

// Returns empty if the site has no claim, and an Error if a worker keeps it.
Expected<std::optional<v1::SiteClaim>> last_claim(Broker& broker, const std::string& site) {
  const auto deadline = std::chrono::steady_clock::now() + kRemovalTimeout;
  for (;;) {
    const auto view = inspect_cluster(broker);
    RAYLOC_TRY(view);
    const auto found = view->sites.find(site);
    if (found == view->sites.end()) {
      return std::nullopt;
    }
    if (!view->has_owner(found->second.claim)) {
      return found->second.claim;
    }
    if (std::chrono::steady_clock::now() > deadline) {
      return make_error(ErrorKind::kUnavailable,
                        "worker '" + found->second.claim.worker() + "' goes on with site '" + site +
                            "': take it out of its configuration, have it reload, and try again");
    }
    std::this_thread::sleep_for(kRemovalStep);
  }
}

// Returns false if a worker has claimed the site meanwhile.
Expected<bool> close_claim(Broker& broker, const std::string& site, std::uint64_t generation) {
  const auto last = broker.last_of(std::string(kClaimStream), claim_subject(site));
  RAYLOC_TRY(last);
  v1::SiteClaim now;
  if (!*last || !unseal((*last)->data, now) || now.generation() != generation) {
    return false;
  }
  v1::SiteClaim removed;
  removed.set_generation(generation);
  removed.set_removed(true);
  const auto sent = broker.publish_behind(claim_subject(site), seal(removed), (*last)->sequence);
  return sent ? Expected<bool>(sent->is_last) : tl::make_unexpected(sent.error());
}

}  // namespace

Expected<void> reopen_claim(Broker& broker, const std::string& site) {
  if (!broker.stream_state(std::string(kClaimStream))) {
    return {};  // no worker has ever claimed a site
  }
  const auto last = broker.last_of(std::string(kClaimStream), claim_subject(site));
  v1::SiteClaim claim;
  if (!last || !*last || !unseal((*last)->data, claim) || !claim.removed()) {
    return last ? Expected<void>() : tl::make_unexpected(last.error());
  }
  v1::SiteClaim no_owner;
  no_owner.set_generation(claim.generation());
  const auto sent = broker.publish_behind(claim_subject(site), seal(no_owner), (*last)->sequence);
  return sent ? Expected<void>() : tl::make_unexpected(sent.error());
}

Expected<void> remove_site(Broker& broker, const std::string& site) {
  const auto retracted = retract(broker, site);
  RAYLOC_TRY(retracted);
  const auto claim = last_claim(broker, site);
  RAYLOC_TRY(claim);
  // A stream without a claim is left over from an earlier attempt that failed to delete it.
  if (!*claim && !*retracted && !broker.stream_state(csi_stream(site))) {
    return make_error(ErrorKind::kUnavailable,
                      "no site '" + site +
                          "' was applied or claimed; `rayloc cluster sites` lists "
                          "those that were");
  }
  if (*claim) {
    const auto closed = close_claim(broker, site, (*claim)->generation());
    if (!closed || !*closed) {
      return closed ? make_error(ErrorKind::kUnavailable,
                                 "site '" + site + "' was claimed meanwhile; try again")
                    : tl::make_unexpected(closed.error());
    }
  }
  return forget_stream(broker, csi_stream(site));
}

}  // namespace rayloc
