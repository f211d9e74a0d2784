// `rayloc cluster apply`: publishes a site for all workers. A site that fails
// its checks is refused with a message, and workers keep the previous one.
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "daemon/cli/verbs/arguments/site_check.h"
#include "daemon/cli/verbs/cluster/cluster_verbs.h"
#include "daemon/live/cluster/operate/remove_site.h"
#include "daemon/live/cluster/operate/scratch_folder.h"
#include "daemon/live/cluster/operate/site_bundle.h"
#include "daemon/live/cluster/operate/site_folder.h"
#include "daemon/site/model/site.h"
#include "engine/base/printable.h"

namespace rayloc::cli {

Expected<void> run_cluster_apply(const BrokerOptions& options, const ApplyArguments& arguments) {
  const auto bundle = read_bundle(arguments.folder);
  RAYLOC_TRY(bundle);
  const auto fresh = make_temporary_folder("rayloc-apply");
  RAYLOC_TRY(fresh);
  const ScratchFolder around(*fresh);
  const std::filesystem::path copy = *fresh / "site";
  const auto checked = check_bundle(*bundle, copy, check_site);
  if (!checked) {
    return make_error(
        ErrorKind::kConfiguration,
        arguments.folder + ": not applied, what workers have goes on: " + checked.error().message);
  }
  std::string name = arguments.name;
  if (name.empty()) {
    name = load_site(copy)->name;
  }
  if (!is_plain_site_name(name)) {
    return make_error(ErrorKind::kUsage, "'" + printable(name) + "' is no name for a site");
  }
  const auto broker = connect(options);
  RAYLOC_TRY(broker);
  RAYLOC_TRY(store_bundle(**broker, name, *bundle, arguments.replicas));
  RAYLOC_TRY(reopen_claim(**broker, name));
  fmt::print("site {}: {} files, bundle {:.12}: {}\n",
             printable(name),
             bundle->files.size(),
             bundle->hash(),
             printable(*checked));
  return {};
}

}  // namespace rayloc::cli
