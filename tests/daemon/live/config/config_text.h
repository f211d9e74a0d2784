// A configuration for tests, and the errors of a changed one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/live/config/config.h"
#include "tests/support/edited_text.h"
#include "tests/support/test_paths.h"

namespace rayloc::testing {

// Beside the bundled sites, so that `directory = "meeting_room"` is one.
inline const std::filesystem::path kConfigFile =
    std::filesystem::path(test::data_path()) / "sites" / "raylocd.toml";

inline constexpr std::string_view kConfigText = R"(schema = 1
include = ["conf.d/*.toml"]
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
snapshot = "ipc:///run/snapshot"
insecure = true
heartbeat_s = 2.5
send_high_water_mark = 50
[http]
enabled = true
listen = "0.0.0.0:8481"
token_file = "token"
insecure = true
[record]
directory = "recordings"
[cache]
enabled = false
directory = "kept"
[log]
level = "debug"
[curve]
enabled = false
secret_file = "secret"
allow = ["Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID"]
[privacy]
target_id = "hmac"
rotate_h = 2
key_file = "privacy.key"
)";

// The kind of source that kConfigText has not: its site has three access points.
inline constexpr std::string_view kUnixSource = R"([[source]]
access_point = "ap4"
kind = "unix"
path = "/run/raylocd/eth0"
)";

// Kind and address in one.
inline constexpr std::string_view kUrlSource = R"([[source]]
access_point = "ap4"
url = "unix:/run/raylocd/eth0"
)";

// A second configuration, with the keys that kConfigText has not: its lines stay where they are
// named by tests of errors.
inline constexpr std::string_view kOtherText = R"([site]
directory = "meeting_room"
name = "office"
method = "none"
record = false
[[source]]
access_point = "ap1"
site = "office"
kind = "udp"
only_interface = "eth1"
allow = ["10.10.10.10", "192.168.1.0/24"]
stall_after_s = 7.5
[[source]]
access_point = "ap2"
kind = "pcap"
file = "two.pcap"
max_gap_s = 20
[engine]
method = "none"
snapshots = "acquire"
tracks = "cloud"
[publish]
csi = true
[record]
directory = "recordings"
rotate_mb = 3
rotate_every_s = 90
max_total_mb = 5
min_free_mb = 7
ring_s = 11
ring_mb = 13
snapshot_directory = "snapshots"
[http]
base_path = "/rayloc"
origins = ["https://home.example", "http://nas:8480"]
frame_ancestors = ["self", "http://homeassistant.local:8123"]
edit = true
[cluster]
role = "capture"
servers = ["nats://127.0.0.1:4222"]
name = "node1"
tls_ca = "ca.pem"
tls_cert = "node1.pem"
tls_key = "node1.key"
nkey_seed_file = "node1.nkey"
flush_ms = 5
window_mb = 2
keep_s = 3
keep_mb = 4
lease_s = 1.5
capacity = 6
rewarm_s = 7
standby = "hot"
storage = "file"
replicas = 3
retention_s = 90
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
