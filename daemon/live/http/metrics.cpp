#include "daemon/live/http/metrics.h"

#include <google/protobuf/descriptor.h>
#include <prometheus/text_serializer.h>
#include <algorithm>
#include <array>

#include <map>
#include <utility>

#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

bool ends_with(const std::string& text, std::string_view end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// The publisher's counter that is kept for each site.
constexpr std::string_view kOfSites = "csi_dropped";

// Fields that can decrease.
bool is_gauge(const std::string& field) {
  constexpr std::array kGauges = std::to_array<std::string_view>({"tracks",
                                                                  "subscriptions",
                                                                  "stopped",
                                                                  "in_batches",
                                                                  "waiting",
                                                                  "unacknowledged",
                                                                  "kept",
                                                                  "kept_bytes"});
  return ends_with(field, "in_flight") ||
         std::find(kGauges.begin(), kGauges.end(), field) != kGauges.end();
}

class Families {
 public:
  void add(const std::string& name,
           const std::string& help,
           bool counter,
           const Labels& labels,
           double value) {
    MetricFamily& family = families_[name];
    family.name = name;
    family.help = help;
    family.type = counter ? MetricType::Counter : MetricType::Gauge;
    ClientMetric metric;
    metric.label = labels;
    (counter ? metric.counter.value : metric.gauge.value) = value;
    family.metric.push_back(std::move(metric));
  }

  // Adds the numbers of a message of counters, without the field `but`; maps from a reason to a
  // number get the label "reason".
  void add_counters(const std::string& prefix,
                    const Message& message,
                    const Labels& labels,
                    std::string_view but = {}) {
    const auto& reflection = *message.GetReflection();
    for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
      const FieldDescriptor* field = message.GetDescriptor()->field(i);
      const bool counter = !is_gauge(field->name());
      const std::string name = prefix + field->name() + (counter ? "_total" : "");
      const std::string help = field->full_name().substr(std::string_view("rayloc.v1.").size());
      if (!field->is_repeated() && field->cpp_type() == FieldDescriptor::CPPTYPE_UINT64 &&
          field->name() != but) {
        add(name, help, counter, labels, static_cast<double>(reflection.GetUInt64(message, field)));
      }
      for (int k = 0; field->is_map() && k < reflection.FieldSize(message, field); ++k) {
        add_map_entry(name, help, labels, reflection.GetRepeatedMessage(message, field, k));
      }
    }
  }

  std::string text() && {
    std::vector<MetricFamily> all;
    for (auto& [name, family] : families_) {
      all.push_back(std::move(family));
    }
    return prometheus::TextSerializer().prometheus::Serializer::Serialize(all);
  }

 private:
  void add_map_entry(const std::string& name,
                     const std::string& help,
                     Labels labels,
                     const Message& entry) {
    const auto& reflection = *entry.GetReflection();
    const FieldDescriptor* key = entry.GetDescriptor()->map_key();
    const FieldDescriptor* value = entry.GetDescriptor()->map_value();
    if (key->cpp_type() == FieldDescriptor::CPPTYPE_STRING &&
        value->cpp_type() == FieldDescriptor::CPPTYPE_UINT64) {
      labels.push_back({"reason", reflection.GetString(entry, key)});
      add(name, help, true, labels, static_cast<double>(reflection.GetUInt64(entry, value)));
    }
  }

  std::map<std::string, MetricFamily> families_;
};

// Labels with the site first, if there is one.
Labels with(Labels labels, const ClientMetric::Label& more) {
  labels.push_back(more);
  return labels;
}

void add_source(const v1::SourceReport& source, const Labels& site, Families& families) {
  const Labels labels = with(site, {"access_point", source.access_point()});
  families.add_counters("rayloc_source_", source.counters(), labels);
  const bool receiving = source.status() == v1::SOURCE_STATUS_RECEIVING;
  families.add("rayloc_source_up", "1 while datagrams come", false, labels, receiving ? 1.0 : 0.0);
  if (source.has_age()) {
    const double age = static_cast<double>(source.age().seconds()) + source.age().nanos() * 1e-9;
    families.add(
        "rayloc_source_silence_seconds", "Time since the last datagram", false, labels, age);
  }
}

void add_chains(const v1::ChainReport& chains, const Labels& site, Families& families) {
  const Labels labels = with(site, {"access_point", chains.access_point()});
  const bool is_learning = chains.knowledge() == v1::CHAIN_KNOWLEDGE_LEARNING;
  families.add("rayloc_chains_learning",
               "1 while the phases of the receive chains of an access point have changed and are "
               "not learned again",
               false,
               labels,
               is_learning ? 1.0 : 0.0);
  for (const v1::ChainTurn& turn : chains.turns()) {
    Labels of_rx_chain = labels;
    of_rx_chain.push_back({"core", std::to_string(turn.core())});
    families.add("rayloc_chain_phase_degrees",
                 "Phase offset of a receive chain since the calibration, as learned",
                 false,
                 of_rx_chain,
                 turn.phase_deg());
    families.add("rayloc_chain_phase_sigma_degrees",
                 "Standard deviation of rayloc_chain_phase_degrees",
                 false,
                 of_rx_chain,
                 turn.phase_sigma_deg());
  }
}

void add_capture(const v1::CaptureCounters& capture, const Labels& site, Families& families) {
  families.add_counters("rayloc_cluster_", capture, site);
  families.add("rayloc_cluster_connected",
               "1 while the broker of the cluster answers",
               false,
               site,
               capture.connected() ? 1.0 : 0.0);
  for (const v1::BatchCounters& counters : capture.access_points()) {
    families.add_counters(
        "rayloc_cluster_", counters, with(site, {"access_point", counters.access_point()}));
  }
}

double seconds(const google::protobuf::Timestamp& time) {
  return static_cast<double>(time.seconds()) + time.nanos() * 1e-9;
}

void add_site(const SiteHeartbeat& one, Families& families) {
  const v1::Heartbeat& heartbeat = one.heartbeat;
  const Labels site = one.site.empty() ? Labels{} : Labels{{"site", one.site}};
  Labels info = site;
  info.push_back({"version", heartbeat.software_version()});
  info.push_back({"scene", heartbeat.scene_hash()});
  info.push_back({"calibration", heartbeat.calibration_id()});
  families.add("rayloc_info",
               "Version of the software, hash of the scene, identity of the calibration",
               false,
               info,
               1.0);
  families.add("rayloc_start_time_seconds",
               "When the daemon started or the site was prepared anew, in seconds since 1970",
               false,
               site,
               seconds(heartbeat.started()));
  families.add("rayloc_calibration_warnings",
               "Findings against the calibration in use",
               false,
               site,
               heartbeat.calibration_warnings_size());
  families.add_counters("rayloc_estimation_", heartbeat.estimation(), site);
  for (const v1::RankCounters& rank : heartbeat.estimation().ranks()) {
    families.add_counters("rayloc_rank_", rank, with(site, {"rank", rank.rank()}));
  }
  families.add_counters("rayloc_tracker_", heartbeat.tracker(), site);
  families.add_counters("rayloc_person_tracker_", heartbeat.person_tracker(), site);
  families.add("rayloc_publisher_csi_dropped_total",
               "PublisherCounters.csi_dropped",
               true,
               site,
               static_cast<double>(heartbeat.publisher().csi_dropped()));
  if (heartbeat.has_recorder()) {
    families.add_counters("rayloc_recorder_", heartbeat.recorder(), site);
  }
  if (heartbeat.has_reloads()) {
    families.add_counters("rayloc_reload_", heartbeat.reloads(), site);
  }
  for (const v1::SourceReport& source : heartbeat.sources()) {
    add_source(source, site, families);
  }
  if (heartbeat.has_stream()) {
    families.add_counters("rayloc_cluster_stream_", heartbeat.stream(), site);
  }
  if (heartbeat.has_capture()) {
    add_capture(heartbeat.capture(), site, families);
  }
  for (const v1::ChainReport& chains : heartbeat.chains()) {
    add_chains(chains, site, families);
  }
  for (const v1::ComparedCounters& compared : heartbeat.compared()) {
    families.add_counters("rayloc_compared_", compared, with(site, {"method", compared.method()}));
  }
}

}  // namespace

std::string metrics_text(const std::vector<SiteHeartbeat>& sites,
                         const v1::PublisherCounters& publisher,
                         const std::vector<ExtraMetric>& extra) {
  Families families;
  for (const SiteHeartbeat& site : sites) {
    add_site(site, families);
  }
  families.add_counters("rayloc_publisher_", publisher, {}, kOfSites);
  for (const ExtraMetric& metric : extra) {
    for (const ExtraMetric::Sample& sample : metric.samples) {
      const Labels labels =
          sample.label_name.empty() ? Labels{} : Labels{{sample.label_name, sample.label_value}};
      families.add(metric.name, metric.help, metric.counter, labels, sample.value);
    }
  }
  return std::move(families).text();
}

}  // namespace rayloc
