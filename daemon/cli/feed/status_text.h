// Text of `rayloc status`: a pure function of the state that raylocd reports over HTTP.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace rayloc::cli {

struct SiteStatus {
  std::string site;          // its name; empty: the only site
  nlohmann::json readiness;  // of /readyz
  nlohmann::json status;     // the heartbeat, of /api/v1/status; an error if the site never started

  bool has_begun() const { return status.contains("sources"); }
};

struct StatusText {
  std::string text;                    // lines for people, each with its end
  std::vector<std::string> malformed;  // a message for each site that `text` lacks
};
// The state of every site, then the counters of the publisher, which the sites share. A site whose
// state lacks a field, or has one of another type, is left out.
StatusText status_text(const std::vector<SiteStatus>& sites);

// A line of JSON, without its end: "readiness", "status", and "site" where there are several.
std::string status_json(const SiteStatus& site);

}  // namespace rayloc::cli
