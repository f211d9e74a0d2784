// Checks a capture node by the last batch that it has sent: its silence and its clock.
#pragma once

#include <string>
#include <vector>

#include "daemon/base/finding.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

// State of a capture node in the stream of its site.
struct NodeReport {
  std::string node;    // its name
  std::string stream;  // of its site
  v1::CsiBatch last;   // its last batch
  Timestamp stored;    // when the server stored that batch, by its clock
};

// `now`: by the clock of this machine.
std::vector<Finding> check_node(const NodeReport& report, Timestamp now);

}  // namespace rayloc
