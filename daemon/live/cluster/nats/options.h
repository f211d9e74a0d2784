// Security options of a libnats connection; its messages and errors as text.
#pragma once

#include <nats/nats.h>

#include <string>

#include "daemon/live/cluster/broker.h"

namespace rayloc::nats {

std::string data_of(natsMsg* message);
// Fault that the server reports for a message that was to be stored; empty: it is stored.
std::string trouble_in(natsMsg* acknowledgement);

// Error with the text of libnats.
Error error_of(const std::string& what, natsStatus status);

// Our identity towards the servers.
struct Identity {
  std::string nkey;   // the public key; empty: none
  std::string inbox;  // subject prefix of replies to us
};

// Sets TLS and our identity. `nkey`: the public key; empty: none.
Expected<void> secure(natsOptions* made, const BrokerOptions& options, const std::string& nkey);

}  // namespace rayloc::nats
