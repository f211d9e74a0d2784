#include "daemon/messages/location_formats.h"

#include <array>
#include <cctype>
#include <cmath>
#include <string_view>
#include <vector>

#include <google/protobuf/util/time_util.h>
#include <nlohmann/json.hpp>

#include "daemon/messages/geodetic.h"
#include "daemon/messages/topic.h"
#include "engine/base/check.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

std::string time_text(const google::protobuf::Timestamp& time) {
  return google::protobuf::util::TimeUtil::ToString(time);
}

// "FIX_MODE_NO_FIX" -> "no_fix": the name without the prefix that all values of its enum share.
std::string short_name(std::string_view name, std::string_view prefix) {
  name.remove_prefix(name.starts_with(prefix) ? prefix.size() : 0);
  std::string text;
  for (const char c : name) {
    text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

std::string kind_of(const v1::Location& location) {
  return short_name(v1::LocationKind_Name(location.kind()), "LOCATION_KIND_");
}
std::string mode_of(const v1::Location& location) {
  return short_name(v1::FixMode_Name(location.mode()), "FIX_MODE_");
}
std::string state_of(const v1::Location& location) {
  return location.track_state() == v1::TRACK_STATE_UNSPECIFIED
             ? ""
             : short_name(v1::TrackState_Name(location.track_state()), "TRACK_STATE_");
}

Vec3d position_of(const v1::Location& location) {
  return {location.position().x(), location.position().y(), location.position().z()};
}

// A number in JSON and in CSV: the shortest text that parses to the same value.
std::string number_text(double value) { return Json(value).dump(); }

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

// Names come from the network and may be invalid UTF-8.
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Properties that are identical in GeoJSON and omlox.
Json properties_of(const v1::Location& location) {
  Json properties = {{"target", target_component(location.target())},
                     {"name", location.target().name()},
                     {"kind", kind_of(location)},
                     {"mode", mode_of(location)},
                     {"site", location.frame().site()}};
  if (const std::string state = state_of(location); !state.empty()) {
    properties["track_state"] = state;
  }
  if (location.has_accuracy_confidence()) {
    properties["accuracy_confidence"] = location.accuracy_confidence();
  }
  for (const v1::ZoneProbability& zone : location.zones()) {
    properties["zones"][zone.zone()] = zone.probability();
  }
  if (!location.quality().no_fix_reason().empty()) {
    properties["no_fix_reason"] = location.quality().no_fix_reason();
  }
  return properties;
}

// 48 bits in omlox notation: an EUI-64 in upper case without delimiters; other ids unchanged.
std::string provider_id_of(const v1::Target& target) {
  constexpr std::size_t kMacDigits = 12;
  if (!target.has_mac()) {
    return target_component(target);
  }
  std::string digits;
  for (const char c : target.mac()) {
    if (c != ':') {
      digits += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
  }
  return digits.size() == kMacDigits ? digits.insert(kMacDigits / 2, "FFFE") : target.mac();
}

struct Column {
  const char* name;
  std::string (*text)(const v1::Location&);
};

std::string coordinate(const v1::Location& location, double value) {
  return location.has_position() ? number_text(value) : "";
}

std::string zones_text(const v1::Location& location) {
  std::string text;
  for (const v1::ZoneProbability& zone : location.zones()) {
    text += (text.empty() ? "" : ";") + zone.zone() + "=" + number_text(zone.probability());
  }
  return text;
}

using L = const v1::Location&;
constexpr std::array<Column, 18> kColumns = {{
    {"time", [](L l) { return time_text(l.time()); }},
    {"site", [](L l) { return l.frame().site(); }},
    {"target", [](L l) { return target_component(l.target()); }},
    {"name", [](L l) { return l.target().name(); }},
    {"kind", kind_of},
    {"mode", mode_of},
    {"x_m", [](L l) { return coordinate(l, l.position().x()); }},
    {"y_m", [](L l) { return coordinate(l, l.position().y()); }},
    {"z_m", [](L l) { return coordinate(l, l.position().z()); }},
    {"accuracy_m", [](L l) { return l.has_accuracy_m() ? number_text(l.accuracy_m()) : ""; }},
    {"accuracy_confidence",
     [](L l) { return l.has_accuracy_confidence() ? number_text(l.accuracy_confidence()) : ""; }},
    {"residual_probability", [](L l) { return number_text(l.residual_probability()); }},
    {"velocity_x_m_s", [](L l) { return l.has_velocity() ? number_text(l.velocity().x()) : ""; }},
    {"velocity_y_m_s", [](L l) { return l.has_velocity() ? number_text(l.velocity().y()) : ""; }},
    {"track_state", state_of},
    {"zones", zones_text},
    {"frames", [](L l) { return std::to_string(l.quality().frames()); }},
    {"no_fix_reason", [](L l) { return l.quality().no_fix_reason(); }},
}};

}  // namespace

std::string csv_header() {
  std::string line;
  for (const Column& column : kColumns) {
    line += (line.empty() ? "" : ",") + std::string(column.name);
  }
  return line;
}

std::string to_csv(const v1::Envelope& envelope) {
  RAYLOC_CHECK(envelope.has_location());
  std::string line;
  for (const Column& column : kColumns) {
    line += (&column == &kColumns.front() ? "" : ",") + csv_field(column.text(envelope.location()));
  }
  return line;
}

std::string to_geojson(const v1::Envelope& envelope, const v1::Georeference& site) {
  RAYLOC_CHECK(envelope.has_location());
  const v1::Location& location = envelope.location();
  Json feature = {{"type", "Feature"}, {"id", location.event_id()}, {"geometry", nullptr}};
  if (location.has_position()) {
    const GeodeticPoint point = to_geodetic(site, position_of(location));
    feature["geometry"] = {{"type", "Point"},
                           {"coordinates", {point.longitude, point.latitude, point.altitude}}};
  }
  Json properties = {{"time", time_text(location.time())}};
  properties.update(properties_of(location));
  if (location.has_accuracy_m()) {
    properties["accuracy_m"] = location.accuracy_m();
  }
  if (location.frame().has_floor()) {
    properties["floor"] = location.frame().floor();
  }
  if (location.has_velocity()) {
    const v1::Velocity& velocity = location.velocity();
    properties["speed_m_s"] = std::hypot(velocity.x(), velocity.y());
    properties["course_deg"] = course_deg(site, velocity.x(), velocity.y());
  }
  feature["properties"] = std::move(properties);
  return dump(feature);
}

std::optional<std::string> to_omlox(const v1::Envelope& envelope, const v1::Georeference* site) {
  RAYLOC_CHECK(envelope.has_location());
  const v1::Location& location = envelope.location();
  if (!location.has_position()) {
    return std::nullopt;
  }
  const Vec3d local = position_of(location);
  Json coordinates = {local.x, local.y, local.z};
  if (site != nullptr) {
    const GeodeticPoint point = to_geodetic(*site, local);
    coordinates = {point.longitude, point.latitude, local.z};
  }
  // A person without a device has no id: omlox calls such a provider virtual.
  const bool is_device = location.target().kind() != v1::TARGET_KIND_PERSON;
  Json json = {{"position", {{"type", "Point"}, {"coordinates", coordinates}}},
               {"source", location.frame().site()},
               {"provider_type", is_device ? "wifi" : "virtual"},
               {"provider_id", provider_id_of(location.target())},
               {"timestamp_generated", time_text(location.time())},
               {"timestamp_sent", time_text(envelope.sent())},
               {"crs", site != nullptr ? "EPSG:4326" : "local"},
               {"elevation_ref", "floor"}};
  if (location.has_accuracy_m()) {
    json["accuracy"] = location.accuracy_m();
  }
  if (location.frame().has_floor()) {
    json["floor"] = location.frame().floor();
  }
  if (location.has_velocity()) {
    const v1::Velocity& velocity = location.velocity();
    json["speed"] = std::hypot(velocity.x(), velocity.y());
    if (site != nullptr) {
      json["course"] = course_deg(*site, velocity.x(), velocity.y());
    }
  }
  json["properties"] = properties_of(location);
  return dump(json);
}

}  // namespace rayloc
