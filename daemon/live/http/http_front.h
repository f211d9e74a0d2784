// HttpFront: the front end as browsers see it: another server that passes requests on (nginx,
// Caddy, Home Assistant), a name, pages that show the map in a frame.
//
// Headers added by such a server (X-Forwarded-Host, -Prefix, -Proto) are not read: a web page that
// reached us through its own name (DNS rebinding) could write the same.
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

// SCHEME://HOST or SCHEME://HOST:PORT without any suffix; otherwise empty.
std::optional<WebOrigin> parse_origin(std::string_view text);
inline bool is_origin(std::string_view text) { return parse_origin(text).has_value(); }

// "/rayloc" for "/rayloc" and "/rayloc/", "" for "/"; empty if it is not such a path: segments of
// letters, digits and -._~ only, none of them "." or "..".
std::optional<std::string> parse_base_path(std::string_view text);

// "Host: home.example:8443" without its port, in lower case.
std::string host_name(std::string_view host);

// As stated in the configuration; text that cannot be parsed counts as absent.
struct HttpFront {
  // Every PATH is answered at base_path + PATH as well.
  std::string base_path = {};
  // Origins of the map in browsers: a `Host` of theirs is answered, and their pages may control.
  std::vector<std::string> origins = {};
  // Pages that may show the map in a frame: "self", "*", or an origin; empty: none.
  std::vector<std::string> frame_ancestors = {};
};

// Returns true if the text is valid in HttpFront::frame_ancestors.
bool is_frame_ancestor(std::string_view text);

}  // namespace rayloc
