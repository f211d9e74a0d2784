// `rayloc cluster fetch`: writes the applied sites as folders that raylocd's configuration
// includes. A site that fails its checks is refused with a message, and the previous one stays in
// use. raylocd is asked to reload once all folders are written.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/arguments/site_check.h"
#include "daemon/cli/verbs/cluster/cluster_verbs.h"
#include "daemon/live/cluster/operate/bundle_notices.h"
#include "daemon/live/cluster/operate/site_bundle.h"
#include "daemon/live/cluster/operate/site_folder.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

void print_site_change(const SiteDifference& difference, const SiteChange& change) {
  const std::string site = printable(difference.site);
  switch (change.kind) {
    case SiteChange::Kind::kNone:
      break;
    case SiteChange::Kind::kReplaced:
      std::fprintf(stderr, "site '%s' is there: %.12s\n", site.c_str(), difference.hash.c_str());
      break;
    case SiteChange::Kind::kRefused:
      std::fprintf(stderr,
                   "site '%s' is left as it was: %s\n",
                   site.c_str(),
                   printable(change.reason, '\n').c_str());
      break;
    case SiteChange::Kind::kRemoved:
      std::fprintf(stderr, "site '%s' is taken out\n", site.c_str());
      break;
    case SiteChange::Kind::kRemovalFailed:
      std::fprintf(
          stderr, "site '%s' cannot be taken out: %s\n", site.c_str(), change.reason.c_str());
      break;
  }
}

// Returns true if a site has changed.
Expected<bool> update_sites(Broker& broker, SiteFolder& folder) {
  const auto stored = stored_bundles(broker);
  RAYLOC_TRY(stored);
  bool has_changed = false;
  for (const SiteDifference& difference : folder.differences(*stored)) {
    const SiteChange change = folder.settle(broker, difference);
    print_site_change(difference, change);
    has_changed = has_changed || change.has_changed();
  }
  return has_changed;
}

void run_command(const std::string& command) {
  if (command.empty()) {
    return;
  }
  if (const int status = std::system(command.c_str()); status != 0) {  // NOLINT: one thread asks
    std::fprintf(stderr, "'%s' ends with status %d\n", command.c_str(), status);
  }
}

}  // namespace

Expected<void> run_cluster_fetch(const BrokerOptions& options, const FetchArguments& arguments) {
  StopSignal::install();
  std::error_code failed;
  std::filesystem::create_directories(arguments.folder, failed);
  const auto broker = connect(options);
  RAYLOC_TRY(broker);
  const auto notices = BundleNotices::subscribe(**broker);
  RAYLOC_TRY(notices);
  SiteFolder folder(arguments.folder, check_site);
  do {
    const auto changed = update_sites(**broker, folder);
    if (!changed && !arguments.keep_on) {
      return tl::make_unexpected(changed.error());
    }
    if (changed && *changed) {
      run_command(arguments.command);
    }
    if (arguments.keep_on) {
      (*notices)->wait(StopSignal::requested);
    }
  } while (arguments.keep_on && !StopSignal::requested());
  return {};
}

}  // namespace rayloc::cli
