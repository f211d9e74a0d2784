// The heartbeat as metrics of Prometheus (text format 0.0.4).
//
// Every counter of the message becomes a metric by its place and name: estimation.fixes is
// rayloc_estimation_fixes_total, a source's counters carry the label access_point. A field that is
// added to the message becomes a metric automatically.
#pragma once

#include <string>
#include <vector>

#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc {

// A number that is not part of a message.
struct ExtraMetric {
  std::string name;  // whole: "rayloc_http_requests_total"
  std::string help;
  bool counter = false;  // otherwise a gauge
  struct Sample {
    std::string label_name = {};  // empty: no label
    std::string label_value = {};
    double value = 0.0;
  };
  std::vector<Sample> samples;
};

// The heartbeat of one of several sites; its metrics carry the label site.
struct SiteHeartbeat {
  std::string site;  // empty: the only one, without the label
  v1::Heartbeat heartbeat;
};
// `publisher`: sum over all sites, except csi_dropped, which is kept for each site.
std::string metrics_text(const std::vector<SiteHeartbeat>& sites,
                         const v1::PublisherCounters& publisher,
                         const std::vector<ExtraMetric>& extra);

}  // namespace rayloc
