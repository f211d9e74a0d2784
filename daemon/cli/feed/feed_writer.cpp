#include "daemon/cli/feed/feed_writer.h"

#include <utility>

#include "daemon/cli/feed/message_line.h"
#include "daemon/messages/json.h"
#include "daemon/messages/location_formats.h"

namespace rayloc::cli {

const std::vector<std::string>& feed_format_names() {
  static const std::vector<std::string> kNames = {"text", "json", "csv", "geojson", "omlox"};
  return kNames;
}

std::optional<std::string> FeedWriter::header() const {
  return format_ == FeedFormat::kCsv ? std::optional(csv_header()) : std::nullopt;
}

Expected<void> FeedWriter::receive(const v1::Heartbeat& heartbeat) {
  has_received_ = true;
  site_.reset();
  if (heartbeat.has_georeference()) {
    site_ = heartbeat.georeference();
  } else if (format_ == FeedFormat::kGeojson) {
    return make_error(ErrorKind::kConfiguration,
                      "GeoJSON needs latitudes and longitudes, and the site states no place on the "
                      "Earth: add [georeference] with latitude, longitude and rotation_deg to its "
                      "site.toml and restart raylocd");
  }
  return {};
}

void FeedWriter::add(v1::Envelope envelope) {
  if (is_of_locations_only() && !envelope.has_location()) {
    ++without_form_;
    return;
  }
  if (held_.size() >= kMaxHeld) {
    held_.pop_front();
    ++dropped_;
  }
  held_.push_back(std::move(envelope));
}

std::optional<std::string> FeedWriter::next() {
  if (needs_heartbeats() && !has_received_) {
    return std::nullopt;
  }
  while (!held_.empty()) {
    const v1::Envelope envelope = std::move(held_.front());
    held_.pop_front();
    if (std::optional<std::string> line = line_of(envelope)) {
      return line;
    }
    ++without_form_;
  }
  return std::nullopt;
}

std::optional<std::string> FeedWriter::line_of(const v1::Envelope& envelope) const {
  switch (format_) {
    case FeedFormat::kText:
      return message_line(envelope);
    case FeedFormat::kJson: {
      Expected<std::string> json = to_json(envelope);
      return json ? std::optional(*std::move(json)) : std::nullopt;
    }
    case FeedFormat::kCsv:
      return to_csv(envelope);
    case FeedFormat::kGeojson:
      return to_geojson(envelope, *site_);
    case FeedFormat::kOmlox:
      return to_omlox(envelope, site_ ? &*site_ : nullptr);
  }
  return std::nullopt;
}

}  // namespace rayloc::cli
