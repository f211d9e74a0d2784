// Options of the verbs that connect to the NATS servers of a cluster.
#pragma once

#include <memory>

#include "daemon/cli/command/option_parser.h"
#include "daemon/live/cluster/broker.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// The common options: addresses of the servers, and the identity of the client.
std::shared_ptr<BrokerOptions> add_broker_options(OptionParser& sub);
// --tls-ca, --tls-cert, --tls-key, --nkey and --inbox.
void add_identity_options(OptionParser& sub, BrokerOptions& options);
// Waits up to 3 s. Returns an Error if no server answers or accepts the client.
Expected<std::shared_ptr<Broker>> connect(const BrokerOptions& options);

}  // namespace rayloc::cli
