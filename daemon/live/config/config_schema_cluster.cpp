// The rows of the table of keys of [cluster].
#include "daemon/live/config/config_schema_rows.h"

namespace rayloc::config_rows {
namespace {

constexpr std::array<std::string_view, 4> kRoles = {"none", "capture", "worker", "gateway"};
constexpr std::array<std::string_view, 2> kStandbys = {"warm", "hot"};
constexpr std::array<std::string_view, 2> kStorages = {"memory", "file"};

Duration milliseconds_of(const ConfigValue& value) { return from_seconds(1e-3 * number(value)); }

const std::array kClusterOptions = {
    ConfigOption{
        .section = "cluster",
        .key = "role",
        .type = T::kChoice,
        .preset = "\"none\"",
        .choices = kRoles,
        .description =
            "Role of this machine in a cluster: a capture node sends what its sources receive to "
            "the broker, a worker locates from it, a gateway publishes the workers' results",
        .store = [](C& c, const V& v) { c.cluster.role = chosen<ClusterRole>(v, kRoles); }},
    ConfigOption{.section = "cluster",
                 .key = "servers",
                 .type = T::kTexts,
                 .example = R"(["nats://10.0.0.1:4222", "nats://10.0.0.2:4222"])",
                 .description = "The NATS servers of the cluster, with JetStream",
                 .store = [](C& c, const V& v) { c.cluster.servers = texts(v); }},
    ConfigOption{.section = "cluster",
                 .key = "name",
                 .type = T::kText,
                 .example = "\"hall-1\"",
                 .description = "Name of this machine in the cluster; no other machine has it",
                 .store = [](C& c, const V& v) { c.cluster.name = text(v); }},
    ConfigOption{.section = "cluster",
                 .key = "tls_ca",
                 .type = T::kFile,
                 .example = "\"/etc/raylocd/cluster-ca.pem\"",
                 .description =
                     "Authority that signed the servers' certificates; left out, those that this "
                     "machine trusts. With it, or with tls:// in servers, all is encrypted",
                 .store = [](C& c, const V& v) { c.cluster.tls_ca = text(v); }},
    ConfigOption{.section = "cluster",
                 .key = "tls_cert",
                 .type = T::kFile,
                 .example = "\"/etc/raylocd/cluster.pem\"",
                 .description = "Our own certificate, where the servers ask for one",
                 .store = [](C& c, const V& v) { c.cluster.tls_cert = text(v); }},
    ConfigOption{.section = "cluster",
                 .key = "tls_key",
                 .type = T::kFile,
                 .example = "\"/etc/raylocd/cluster.key\"",
                 .description = "Its key",
                 .store = [](C& c, const V& v) { c.cluster.tls_key = text(v); }},
    ConfigOption{.section = "cluster",
                 .key = "nkey_seed_file",
                 .type = T::kFile,
                 .example = "\"/etc/raylocd/cluster.nkey\"",
                 .description = "Identity of this machine at the servers, made by `rayloc keygen "
                                "--nkey`; systemd's credential cluster.nkey when left out",
                 .store = [](C& c, const V& v) { c.cluster.nkey_seed_file = text(v); }},
    ConfigOption{.section = "cluster",
                 .key = "flush_ms",
                 .type = T::kNumber,
                 .preset = "20",
                 .range = {1.0, 1000.0, "ms"},
                 .description = "The longest that a datagram waits for others of its batch",
                 .store = [](C& c, const V& v) { c.cluster.flush = milliseconds_of(v); }},
    ConfigOption{.section = "cluster",
                 .key = "window_mb",
                 .type = T::kInteger,
                 .preset = "8",
                 .range = {1, 1024, "MiB"},
                 .description = "On their way to the broker and not acknowledged, at most",
                 .store = [](C& c, const V& v) { c.cluster.window_bytes = mebibytes(v); }},
    ConfigOption{
        .section = "cluster",
        .key = "keep_s",
        .type = T::kNumber,
        .preset = "30",
        .range = {1.0, 600.0, "s"},
        .description = "How long a batch can be sent again when its consumption is not reported",
        .store = [](C& c, const V& v) { c.cluster.keep = from_seconds(number(v)); }},
    ConfigOption{.section = "cluster",
                 .key = "keep_mb",
                 .type = T::kInteger,
                 .preset = "64",
                 .range = {1, 65536, "MiB"},
                 .description = "At most so much of each site, however short a time that is",
                 .store = [](C& c, const V& v) { c.cluster.keep_bytes = mebibytes(v); }},
    ConfigOption{.section = "cluster",
                 .key = "lease_s",
                 .type = T::kNumber,
                 .preset = "2",
                 .range = {0.5, 60.0, "s"},
                 .description = "A worker that is silent for so long loses its sites to others; "
                                "the same for all workers",
                 .store = [](C& c, const V& v) { c.cluster.lease = from_seconds(number(v)); }},
    ConfigOption{.section = "cluster",
                 .key = "capacity",
                 .type = T::kInteger,
                 .preset = "0",
                 .range = {0, 100'000},
                 .description = "Sites that a worker owns at most; 0: all that others leave",
                 .store = [](C& c, const V& v) { c.cluster.capacity = count(v); }},
    ConfigOption{
        .section = "cluster",
        .key = "rewarm_s",
        .type = T::kNumber,
        .preset = "5",
        .range = {0.0, 30.0, "s"},
        .description = "Length of the data that a worker processes again when it takes a site over",
        .store = [](C& c, const V& v) { c.cluster.rewarm = from_seconds(number(v)); }},
    ConfigOption{.section = "cluster",
                 .key = "standby",
                 .type = T::kChoice,
                 .preset = "\"warm\"",
                 .choices = kStandbys,
                 .description = "How a worker waits for sites of others: warm, it has their rooms "
                                "ready; hot, it also computes along for those that it is next "
                                "for, and compares, at the cost of owning them",
                 .store = [](C& c, const V& v) { c.cluster.is_hot = text(v) == kStandbys[1]; }},
    ConfigOption{.section = "cluster",
                 .key = "storage",
                 .type = T::kChoice,
                 .preset = "\"memory\"",
                 .choices = kStorages,
                 .description = "Where servers keep the stream of a site, where this machine makes "
                                "it",
                 .store = [](C& c, const V& v) { c.cluster.in_memory = text(v) == kStorages[0]; }},
    ConfigOption{
        .section = "cluster",
        .key = "replicas",
        .type = T::kInteger,
        .preset = "1",
        .range = {1, 5},
        .description = "On how many servers; 3 for a cluster that may lose one",
        .store = [](C& c, const V& v) { c.cluster.replicas = static_cast<int>(count(v)); }},
    ConfigOption{
        .section = "cluster",
        .key = "retention_s",
        .type = T::kInteger,
        .preset = "60",
        .range = {5, 86400, "s"},
        .description = "How long they keep it",
        .store = [](C& c, const V& v) { c.cluster.retention = std::chrono::seconds(count(v)); }},
};

}  // namespace

std::span<const ConfigOption> cluster_options() { return kClusterOptions; }

}  // namespace rayloc::config_rows
