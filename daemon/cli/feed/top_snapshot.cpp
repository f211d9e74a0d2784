#include "daemon/cli/feed/top_snapshot.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <vector>

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

Expected<Receive> connect_with_snapshot(const MessageSource& from, double patience) {
  constexpr double kMaxPatience = 2.0;  // [s]
  const std::vector<std::string> all = {"v1/"};
  const std::optional<std::string> usual =
      from.snapshot.empty() ? usual_snapshot(from.endpoint) : std::nullopt;
  if (usual) {
    MessageSource late = from;
    late.snapshot = *usual;
    late.patience =
        std::chrono::milliseconds(std::llround(1000.0 * std::min(patience, kMaxPatience)));
    if (Expected<Receive> receive = connect(late, all)) {
      return receive;
    }
  }
  return connect(from, all);
}

}  // namespace rayloc::cli
