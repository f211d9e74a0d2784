// HttpFront: what browsers see before this server: another server that passes requests on (nginx,
// Caddy, Home Assistant), a name, pages that show the map in a frame.
//
// What such a server adds to a request (X-Forwarded-Host, -Prefix, -Proto) is not read: a page of
// the web that reached us through a name of its own (DNS rebinding) could write the same.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rayloc {

// The origin of a page, "https://home.example:8443", in lower case.
struct WebOrigin {
  std::string scheme;  // "http" or "https"
  std::string host;    // a name, an IPv4 address, or an IPv6 address in brackets
  std::uint16_t port = 0;

  bool operator==(const WebOrigin&) const = default;
};

// SCHEME://HOST or SCHEME://HOST:PORT, with nothing behind it; else nothing.
std::optional<WebOrigin> parse_origin(std::string_view text);
inline bool is_origin(std::string_view text) { return parse_origin(text).has_value(); }

// "/rayloc" of "/rayloc" and "/rayloc/", "" of "/"; nothing for what is no path of that kind:
// segments of letters, digits and -._~ alone, none of them "." or "..".
std::optional<std::string> parse_base_path(std::string_view text);

// "Host: home.example:8443" without its port, in lower case.
std::string host_name(std::string_view host);

// As it is written in the configuration; what cannot be parsed counts as absent.
struct HttpFront {
  // What is answered at PATH is answered at base_path + PATH as well.
  std::string base_path = {};
  // Where browsers find the map: a `Host` of theirs is answered, and their pages may control.
  std::vector<std::string> origins = {};
  // Whose pages may show the map in a frame: "self", "*", or an origin; empty: nobody's.
  std::vector<std::string> frame_ancestors = {};
};

// Whether it may stand in HttpFront::frame_ancestors.
bool is_frame_ancestor(std::string_view text);

}  // namespace rayloc
