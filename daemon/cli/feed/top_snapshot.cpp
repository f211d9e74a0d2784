#include "daemon/cli/feed/top_snapshot.h"

#include <string_view>

namespace rayloc::cli {

std::optional<std::string> usual_snapshot(const std::string& endpoint) {
  constexpr std::string_view kTcp = "tcp://";
  constexpr std::string_view kUsualPort = ":5560";
  if (!endpoint.starts_with(kTcp) || !endpoint.ends_with(kUsualPort) ||
      endpoint.size() <= kTcp.size() + kUsualPort.size()) {
    return std::nullopt;
  }
  return endpoint.substr(0, endpoint.size() - kUsualPort.size()) + ":5561";
}

}  // namespace rayloc::cli
