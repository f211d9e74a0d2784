// How a connection of libnats is secured; its messages and errors in words.
#pragma once

#include <nats/nats.h>

#include <string>

#include "daemon/cluster/broker.h"

namespace rayloc {

std::string data_of(natsMsg* message);
// What the server thinks of a message that was to be stored; empty: it is.
std::string trouble_in(natsMsg* acknowledgement);

// With what libnats says of it.
Error error_of(const std::string& what, natsStatus status);

// Who we are to the servers.
struct NatsIdentity {
  std::string nkey;   // the public one; empty: none
  std::string inbox;  // where answers to us begin
};

// TLS, and who we are. `nkey`: the public one; empty: none.
Expected<void> secure(natsOptions* made, const BrokerOptions& options, const std::string& nkey);

}  // namespace rayloc
