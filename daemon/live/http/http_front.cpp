#include "daemon/live/http/http_front.h"

#include <algorithm>
#include <charconv>

namespace rayloc {
namespace {

constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kName = "abcdefghijklmnopqrstuvwxyz0123456789-._";
constexpr std::string_view kAddress = "0123456789abcdef:.";  // IPv6, within brackets

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return lower;
}

bool consists_of(std::string_view text, std::string_view characters) {
  return !text.empty() && text.find_first_not_of(characters) == std::string_view::npos;
}

// "home.example" and ":8443"; "[::1]" and "".
std::size_t end_of_host(std::string_view text) {
  const std::size_t bracket = text.rfind(']');
  return std::min(text.find(':', bracket == std::string_view::npos ? 0 : bracket), text.size());
}

bool is_host(std::string_view host) {
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    return consists_of(host.substr(1, host.size() - 2), kAddress);
  }
  return consists_of(host, kName);
}

}  // namespace

std::optional<WebOrigin> parse_origin(std::string_view text) {
  const std::string lower = in_lower_case(text);
  constexpr std::string_view kBetween = "://";
  const std::size_t between = lower.find(kBetween);
  if (between == std::string::npos) {
    return std::nullopt;
  }
  WebOrigin origin{lower.substr(0, between), {}, 0};
  const std::string_view rest = std::string_view(lower).substr(between + kBetween.size());
  origin.host = rest.substr(0, end_of_host(rest));
  if ((origin.scheme != "http" && origin.scheme != "https") || !is_host(origin.host)) {
    return std::nullopt;
  }
  constexpr std::uint16_t kHttp = 80;
  constexpr std::uint16_t kHttps = 443;
  origin.port = origin.scheme == "http" ? kHttp : kHttps;
  if (rest.size() > origin.host.size()) {
    const std::string_view port = rest.substr(origin.host.size() + 1);
    const auto read = std::from_chars(port.data(), port.data() + port.size(), origin.port);
    if (!consists_of(port, kDigits) || read.ec != std::errc() || origin.port == 0) {
      return std::nullopt;
    }
  }
  return origin;
}

std::optional<std::string> parse_base_path(std::string_view text) {
  constexpr std::string_view kPath =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  if (!consists_of(text, kPath) || text.front() != '/') {
    return std::nullopt;
  }
  if (text.back() == '/') {
    text.remove_suffix(1);
  }
  const std::string path(text);
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin + 1), path.size());
    const std::string segment = path.substr(begin + 1, end - begin - 1);
    if (segment.empty() || segment == "." || segment == "..") {
      return std::nullopt;
    }
    begin = end;
  }
  return path;
}

std::string host_name(std::string_view host) {
  return in_lower_case(host.substr(0, end_of_host(host)));
}

bool is_frame_ancestor(std::string_view text) {
  return text == "self" || text == "*" || is_origin(text);
}

}  // namespace rayloc
