// The connection to NATS is a separate module, which a program
// loads when it belongs to a cluster: no other code needs libnats.
#pragma once

#include <memory>
#include <string>

#include "daemon/live/cluster/broker.h"

namespace rayloc::nats {

// `nkey`: the public key for `options`; empty: none.
using Open = void (*)(const BrokerOptions& options,
                      const std::string& nkey,
                      Expected<std::shared_ptr<Broker>>& opened);
inline constexpr const char* kOpen = "rayloc_open_nats";
// Relative to the folder of the program: /usr/sbin/raylocd has /usr/lib/rayloc/nats.so.
inline constexpr const char* kModule = "../lib/rayloc/nats.so";

}  // namespace rayloc::nats

extern "C" __attribute__((visibility("default"))) void rayloc_open_nats(
    const rayloc::BrokerOptions& options,
    const std::string& nkey,
    rayloc::Expected<std::shared_ptr<rayloc::Broker>>& opened);
