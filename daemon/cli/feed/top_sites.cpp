#include "daemon/cli/feed/top_sites.h"

#include <algorithm>
#include <utility>

#include "daemon/cli/feed/top_view.h"
#include "daemon/messages/topic.h"
#include "engine/base/printable.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::cli {

void TopSites::add(const PublishedMessage& message, TopModel::Clock::time_point now) {
  v1::Envelope envelope;
  if (envelope.ParseFromString(message.payload)) {
    models_[std::string(topic_site(message.topic))].add(
        message.topic, envelope, now, message.from_snapshot);
  }
}

bool TopSites::has_heartbeat() const {
  return std::any_of(models_.begin(), models_.end(), [](const auto& one) {
    return one.second.heartbeat().has_value();
  });
}

bool TopSites::has_shown_site() const {
  return std::any_of(
      models_.begin(), models_.end(), [&](const auto& one) { return is_shown(one.first); });
}

bool TopSites::is_complete(std::uint64_t heartbeats) const {
  return !models_.empty() && std::all_of(models_.begin(), models_.end(), [&](const auto& one) {
    return !is_shown(one.first) || one.second.heartbeats() >= heartbeats || one.second.goodbye();
  });
}

std::vector<std::string> TopSites::lines(TopModel::Clock::time_point now, std::size_t width) const {
  std::vector<std::string> lines;
  for (const auto& [site, model] : models_) {
    if (!is_shown(site)) {
      continue;
    }
    if (models_.size() > 1 && only_.empty()) {
      lines.insert(lines.end(), lines.empty() ? 0U : 1U, "");
      lines.push_back("site " + printable(decoded_component(site)));
    }
    for (std::string& line : top_lines(model, now, width)) {
      lines.push_back(std::move(line));
    }
  }
  return lines.empty() ? top_lines(TopModel(), now, width) : lines;
}

bool TopSites::is_shown(const std::string& component) const {
  return only_.empty() || decoded_component(component) == only_;
}

}  // namespace rayloc::cli
