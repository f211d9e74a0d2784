#include "daemon/cli/feed/status_text.h"

#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "daemon/cli/feed/age_text.h"

namespace rayloc::cli {
namespace {

using StatusJson = nlohmann::json;

// 64-bit numbers are strings in protobuf's JSON.
std::uint64_t count_of(const StatusJson& object, const char* key) {
  const StatusJson value = object.value(key, StatusJson(0));
  return value.is_string() ? std::stoull(value.get<std::string>()) : value.get<std::uint64_t>();
}

std::string lower_tail(const std::string& name, std::size_t prefix) {
  std::string text = name.size() > prefix ? name.substr(prefix) : name;
  for (char& c : text) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

// Parses JSON's "0.023330128s".
double seconds_of(const std::string& duration) { return std::strtod(duration.c_str(), nullptr); }

// Time of the last datagram; a recording's datagrams came long ago, at any time.
std::string last_of(const StatusJson& source) {
  if (source.contains("age")) {
    return age_text(seconds_of(source.at("age").get<std::string>())) + " ago";
  }
  if (count_of(source.at("counters"), "received") == 0) {
    return "no datagram yet";
  }
  return source.at("status") == "SOURCE_STATUS_WAITING" ? "none that is wanted yet"
                                                        : "from a recording";
}

std::string source_text(const StatusJson& source) {
  const StatusJson& counters = source.at("counters");
  std::uint64_t rejected = 0;
  for (const auto& [reason, count] : counters.at("rejected").items()) {
    rejected += count.is_string() ? std::stoull(count.get<std::string>()) : 0U;
  }
  constexpr std::size_t kPrefix = std::string_view("SOURCE_STATUS_").size();
  const std::uint64_t partial = count_of(counters, "frames_partial");
  return fmt::format(
      "{:<12} {:<10} {:>12} datagrams {:>8} frames ({} partial) {:>6} rejected {:>6} lost  {}\n",
      source.at("access_point").get<std::string>(),
      lower_tail(source.at("status").get<std::string>(), kPrefix),
      count_of(counters, "received"),
      count_of(counters, "frames_complete") + partial,
      partial,
      rejected,
      count_of(counters, "kernel_drops") + count_of(counters, "ring_dropped") +
          count_of(counters, "late") + count_of(counters, "frames_dropped"),
      last_of(source));
}

// Number of tracks; people are included if the site locates them with a measured empty room.
std::string tracks_of(const StatusJson& status) {
  std::string text = fmt::format("{} tracks of devices",
                                 count_of(status.value("tracker", StatusJson::object()), "tracks"));
  if (status.contains("person_tracker")) {
    text += fmt::format(", {} of people", count_of(status.at("person_tracker"), "tracks"));
  }
  return text;
}

// "2026-11-26T22:00:00.123456789Z" without the fraction.
std::string to_the_second(const std::string& time) {
  const std::size_t point = time.find('.');
  return point == std::string::npos ? time : time.substr(0, point) + "Z";
}

// Publisher state, shared by all sites.
std::string publisher_of(const StatusJson& status) {
  const StatusJson& publisher = status.at("publisher");
  return fmt::format("{} messages to {} subscriptions, {} times one was slow",
                     count_of(publisher, "published"),
                     count_of(publisher, "subscriptions"),
                     count_of(publisher, "slow_episodes"));
}

// The version, the readiness and the reasons against it.
std::string readiness_text(const StatusJson& ready, const StatusJson& status) {
  std::string text = fmt::format("raylocd {} since {}: {}\n",
                                 status.at("software_version").get<std::string>(),
                                 to_the_second(status.at("started").get<std::string>()),
                                 ready.at("ready").get<bool>() ? "ready" : "not ready");
  for (const StatusJson& reason : ready.at("reasons")) {
    text += fmt::format("  {}\n", reason.get<std::string>());
  }
  for (const StatusJson& warning : ready.at("warnings")) {
    text += fmt::format("  warning: {}\n", warning.get<std::string>());
  }
  if (ready.value("clock", "") == "unknown") {
    text += "  clock: synchronisation unknown to raylocd; timedatectl shows it\n";
  }
  return text;
}

// `end`: end of the line of estimates.
std::string estimation_text(const StatusJson& status, const std::string& end) {
  const StatusJson& estimation = status.at("estimation");
  std::string text = fmt::format(
      "{} fixes, {} without a position, {}; {} bursts gave way to newer ones, {} were left out{}\n",
      count_of(estimation, "fixes"),
      count_of(estimation, "no_fixes"),
      tracks_of(status),
      count_of(estimation, "bursts_merged"),
      count_of(estimation, "bursts_dropped"),
      end);
  for (const StatusJson& compared : status.value("compared", StatusJson::array())) {
    text += fmt::format("compared {}: {} fixes, {} without a position; {} bursts dropped\n",
                        compared.value("method", ""),
                        count_of(compared, "fixes"),
                        count_of(compared, "no_fixes"),
                        count_of(compared, "bursts_dropped"));
  }
  const StatusJson reloads = status.value("reloads", StatusJson::object());
  if (count_of(reloads, "exchanges") > 0) {
    text +=
        fmt::format("prepared anew {} times since the start: {} datagrams lost, {} frames left\n",
                    count_of(reloads, "exchanges"),
                    count_of(reloads, "datagrams_lost"),
                    count_of(reloads, "frames_left"));
  }
  return text;
}

std::string state_text(const SiteStatus& site, const std::string& end) {
  std::string text = readiness_text(site.readiness, site.status);
  for (const StatusJson& source : site.status.at("sources")) {
    text += source_text(source);
  }
  return text + estimation_text(site.status, end);
}

// `publisher`: the publisher's state by the first site that states it; empty until then.
std::string site_text(const SiteStatus& site, std::string& publisher) {
  if (site.site.empty()) {
    return state_text(site, "; " + publisher_of(site.status));
  }
  if (!site.has_begun()) {
    return fmt::format("not ready: {}\n", site.status.value("error", "it states no reason"));
  }
  std::string text = state_text(site, "");
  const std::string stated = publisher_of(site.status);
  publisher = publisher.empty() ? stated : publisher;
  return text;
}

std::string malformed_text(const SiteStatus& site, std::string_view problem) {
  return fmt::format("{} is malformed: {}; are rayloc and raylocd of the same version?",
                     site.site.empty() ? "the status" : "the status of site '" + site.site + "'",
                     problem);
}

}  // namespace

StatusText status_text(const std::vector<SiteStatus>& sites) {
  StatusText all;
  std::string publisher;
  for (const SiteStatus& site : sites) {
    try {
      const std::string text = site_text(site, publisher);
      if (!site.site.empty()) {
        all.text += fmt::format("{}site {}\n", all.text.empty() ? "" : "\n", site.site);
      }
      all.text += text;
    } catch (const StatusJson::exception& error) {
      all.malformed.push_back(malformed_text(site, error.what()));
    } catch (const std::logic_error&) {  // std::stoull
      all.malformed.push_back(malformed_text(site, "a count is not a number"));
    }
  }
  if (!publisher.empty()) {
    all.text += fmt::format("\n{}\n", publisher);
  }
  return all;
}

std::string status_json(const SiteStatus& site) {
  StatusJson line = {{"readiness", site.readiness}, {"status", site.status}};
  if (!site.site.empty()) {
    line["site"] = site.site;
  }
  return line.dump();
}

}  // namespace rayloc::cli
