#include "daemon/live/service/reloader.h"

namespace rayloc {

Expected<Reloader::Reload> Reloader::reload(const RunningSetup& running) {
  // The setup reads the site as well: a configuration whose site is broken would not start.
  Expected<DaemonSetup> setup = reload_daemon_setup(file_, running);
  RAYLOC_TRY(setup);
  const InputFiles now = InputFiles::of(*setup);
  Reload reload{
      std::move(setup->config), std::move(setup->sites), values_.changes_to(setup->values)};
  for (const std::string& file : inputs_.changes_to(now)) {
    reload.changes.needs_restart.push_back("the content of " + file);
  }
  values_.adopt_applicable(setup->values);
  return reload;
}

}  // namespace rayloc
