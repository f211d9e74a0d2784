// raylocd's configuration: any text gives a configuration that keeps its promises, or errors.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "daemon/live/config/config.h"
#include "daemon/live/config/endpoint.h"

namespace {

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using rayloc::EndpointReach;
  const rayloc::Expected<rayloc::DaemonConfig> config = rayloc::parse_config(
      {reinterpret_cast<const char*>(data), size}, "/nonexistent/raylocd.toml");
  if (!config) {
    require(config.error().message.rfind("/nonexistent/raylocd.toml:", 0) == 0);
    return 0;
  }
  require(!config->sources.empty());
  require(!config->sites.empty() && !config->sites.front().directory.empty());
  require(config->engine.burst > rayloc::Duration::zero());
  require(config->limits.ring_frames > 0 && config->limits.max_targets > 0);
  const EndpointReach reach = rayloc::endpoint_reach(config->publish.endpoint);
  require(reach == EndpointReach::kLoopback ||
          (reach == EndpointReach::kNetwork && config->publish.insecure));
  return 0;
}
