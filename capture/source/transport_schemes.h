// All transports: one row each, which is defined beside its implementation.
#pragma once

#include "capture/transport/transport_scheme.h"

namespace rayloc {

extern const TransportScheme kUdpScheme;   // udp_source.cpp
extern const TransportScheme kPcapScheme;  // recorded_source.cpp
extern const TransportScheme kUnixScheme;  // unix_source.cpp
extern const TransportScheme kLiveScheme;  // pcap_live_source.cpp

// The table that configuration, survey, record, send and rayloc-capture use.
TransportTable transport_schemes();

}  // namespace rayloc
