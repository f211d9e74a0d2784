// HOST:PORT of a UDP endpoint.
#pragma once

#include <netinet/in.h>

#include <string>

#include "engine/base/expected.h"

namespace rayloc {

// HOST is an IPv4 address or a name that has one; "*" or empty is any address. kUsage otherwise.
Expected<sockaddr_in> parse_udp_address(const std::string& text);

// "10.10.10.10:5500"
std::string to_string(const sockaddr_in& address);

}  // namespace rayloc
