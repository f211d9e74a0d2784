// TopSites: the models of all sites of a daemon for `rayloc top`, by the site in their topics.
//
// Thread safety: one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/feed/top_model.h"
#include "daemon/cli/terminal/text_table.h"
#include "daemon/live/publish/subscriber.h"

namespace rayloc::cli {

class TopSites {
 public:
  // `only`: the name of the site that is shown; empty: all.
  explicit TopSites(std::string only) : only_(std::move(only)) {}

  // In order of arrival. A message that is no Envelope is ignored.
  void add(const PublishedMessage& message, TopModel::Clock::time_point now);

  bool has_heartbeat() const;   // from any site
  bool has_shown_site() const;  // a message of a site that is shown was received
  // Every site that is shown has sent so many heartbeats, or its farewell. False without a message.
  bool is_complete(std::uint64_t heartbeats) const;

  // The sites one below the other, each with its name if there are several; as top_lines().
  std::vector<std::string> lines(TopModel::Clock::time_point now,
                                 std::size_t width = kAnyWidth) const;

 private:
  bool is_shown(const std::string& component) const;

  std::string only_;
  std::map<std::string, TopModel> models_;  // by topic component
};

}  // namespace rayloc::cli
