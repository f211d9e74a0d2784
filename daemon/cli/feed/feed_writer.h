// FeedWriter: converts messages to the lines that `rayloc sub` prints, in the requested format.
//
// GeoJSON and omlox need the site's georeference, which the heartbeat states each second: until the
// first one is received, messages are held (at most kMaxHeld; beyond that the oldest are dropped
// and counted). csv, geojson and omlox represent locations only; other messages are left out.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::cli {

enum class FeedFormat : std::uint8_t { kText, kJson, kCsv, kGeojson, kOmlox };

// Names of the formats, in the order of the enumerators: "text", "json", ...
const std::vector<std::string>& feed_format_names();

class FeedWriter {
 public:
  static constexpr std::size_t kMaxHeld = 10'000;

  explicit FeedWriter(FeedFormat format) : format_(format) {}

  bool needs_heartbeats() const {
    return format_ == FeedFormat::kGeojson || format_ == FeedFormat::kOmlox;
  }
  bool is_of_locations_only() const { return needs_heartbeats() || format_ == FeedFormat::kCsv; }
  // Line before all messages; nothing except for csv.
  std::optional<std::string> header() const;

  // Takes a heartbeat that is not to be printed. kConfiguration:
  // the site states no georeference and the format requires one.
  Expected<void> receive(const v1::Heartbeat& heartbeat);

  // Takes a message that is to be printed.
  void add(v1::Envelope envelope);
  // Returns the next line to print.
  std::optional<std::string> next();

  std::uint64_t without_form() const { return without_form_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::optional<std::string> line_of(const v1::Envelope& envelope) const;

  FeedFormat format_;
  bool has_received_ = false;
  std::optional<v1::Georeference> site_;
  std::deque<v1::Envelope> held_;
  std::uint64_t without_form_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace rayloc::cli
