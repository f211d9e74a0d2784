// `rayloc cluster doctor`: reports the problems of a cluster
// with a remedy for each. It only reads and changes nothing.
#include <iterator>
#include <utility>
#include <vector>

#include "daemon/cli/verbs/cluster/cluster_verbs.h"
#include "daemon/cli/verbs/report/findings.h"
#include "daemon/live/cluster/operate/cluster_check.h"

namespace rayloc::cli {

Expected<void> run_cluster_doctor(const BrokerOptions& options) {
  auto [findings, has_several_servers] = check_servers(options.servers);
  const auto broker = connect(options);
  std::vector<Finding> more = broker ? check_cluster(**broker, has_several_servers)
                                     : std::vector{Finding::problem(broker.error().message)};
  findings.insert(
      findings.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  return print_findings(findings);
}

}  // namespace rayloc::cli
