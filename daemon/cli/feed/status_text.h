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

// Lines for people, each with its end: the state of every site, then the counters of the publisher,
// which the sites share. Throws nlohmann::json::exception where the state lacks a field.
std::string status_text(const std::vector<SiteStatus>& sites);

// A line of JSON, without its end: "readiness", "status", and "site" where there are several.
std::string status_json(const SiteStatus& site);

}  // namespace rayloc::cli
