// A configuration for tests, and the errors of a changed one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/service/config.h"
#include "tests/support/edited_text.h"

namespace rayloc::testing {

// Beside the bundled sites, so that `directory = "meeting_room"` is one.
inline const std::filesystem::path kConfigFile =
    std::filesystem::path(RAYLOC_TEST_DATA) / "sites" / "raylocd.toml";

inline constexpr std::string_view kConfigText = R"(schema = 1
[site]
directory = "meeting_room"
[[source]]
access_point = "ap1"
kind = "udp"
listen = "127.0.0.1:5501"
[[source]]
access_point = "ap2"
kind = "pcap"
file = "two.pcap"
speed = 2
format = "axcsi-v4"
[[source]]
access_point = "ap3"
kind = "interface"
interface = "eth0"
filter = "udp port 5503"
[engine]
burst_s = 0.5
accuracy_confidence = 0.9
[limits]
ring_frames = 100
max_targets = 7
[publish]
endpoint = "tcp://0.0.0.0:5561"
insecure = true
heartbeat_s = 2.5
send_high_water_mark = 50
[record]
directory = "recordings"
[log]
level = "debug"
)";

// kConfigText with the first `from` replaced by `to`.
inline std::string config_text(std::string_view from = "", std::string_view to = "") {
  return edited_text(std::string(kConfigText), from, to);
}

// The message, folders of files taken out: "raylocd.toml:3:1: ...".
inline std::string without_folders(std::string message) {
  return without_folder(std::move(message), kConfigFile);
}

inline std::string errors_of(std::string_view text) {
  const Expected<DaemonConfig> config = parse_config(text, kConfigFile);
  return config ? "" : without_folders(config.error().message);
}

}  // namespace rayloc::testing
