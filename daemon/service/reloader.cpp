#include "daemon/service/reloader.h"

namespace rayloc {

Expected<Reloader::Reload> Reloader::reload() {
  // The setup reads the site as well: a configuration whose site is broken would not start.
  Expected<DaemonSetup> setup = load_daemon_setup(file_);
  if (!setup) {
    return tl::make_unexpected(setup.error());
  }
  const Expected<ConfigValues> now = ConfigValues::read(file_);
  if (!now) {
    return tl::make_unexpected(now.error());
  }
  Reload reload{std::move(setup->config), values_.changes_to(*now)};
  values_.adopt_applicable(*now);
  return reload;
}

}  // namespace rayloc
