// Checks the streams on the servers against those that raylocd makes, and the storage they take.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/base/finding.h"
#include "daemon/live/cluster/operate/stream_admin.h"

namespace rayloc {

// A stream that raylocd makes, with the options that its readers depend on.
struct RequiredStream {
  std::string name;
  std::string republish_to;
  std::int64_t messages_per_subject = 0;  // maximum; 0: any number
};

RequiredStream required_claim_stream();
RequiredStream required_output_stream();
RequiredStream required_csi_stream(const std::string& site);

// `streams`: those on the servers. `has_several_servers`: a single replica is then a fault.
std::vector<Finding> check_stream(const RequiredStream& required,
                                  const std::vector<StreamReport>& streams,
                                  bool has_several_servers);

// Reports storage that has nearly reached the limit of the account.
std::vector<Finding> check_store(const StoreReport& store);

}  // namespace rayloc
