#include "daemon/cli/feed/message_line.h"

#include <algorithm>
#include <chrono>

#include <spdlog/fmt/fmt.h>

#include "daemon/messages/proto_time.h"
#include "engine/base/printable.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::cli {
namespace {

std::string time_of_day(const google::protobuf::Timestamp& time) {
  using std::chrono::milliseconds;
  const auto since_midnight = std::chrono::floor<milliseconds>(
      from_proto(time) - std::chrono::floor<std::chrono::days>(from_proto(time)));
  const auto ms = since_midnight.count();
  return fmt::format(
      "{:02}:{:02}:{:02}.{:03}", ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60, ms % 1000);
}

// "FIX_MODE_NO_FIX" -> "no_fix": the name without the prefix that all values of its enum share.
std::string enum_word(const std::string& name, std::size_t prefix) {
  std::string text;
  for (const char c : name.substr(std::min(prefix, name.size()))) {
    text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return text;
}

std::string name_of(const v1::Target& target) {
  std::string name = target.mac();
  if (target.has_hashed_mac()) {
    name = target.hashed_mac();
  } else if (name.empty()) {
    name = "person-" + std::to_string(target.track());
  }
  return target.name().empty() ? name : target.name() + " (" + name + ")";
}

std::string describe(const v1::Location& location, const char* topics = "location") {
  const bool filtered = location.kind() == v1::LOCATION_KIND_FILTERED;
  std::string text = fmt::format(
      "{:<10} {} {}", topics, name_of(location.target()), filtered ? "filtered" : "snapshot");
  if (!location.has_position()) {
    return text + ": no fix: " + location.quality().no_fix_reason();
  }
  const v1::Point& p = location.position();
  text += fmt::format(": {:.2f}, {:.2f}, {:.2f} m", p.x(), p.y(), p.z());
  if (location.has_accuracy_m()) {
    text += fmt::format(", {:.0f} % within {:.2f} m",
                        100.0 * location.accuracy_confidence(),
                        location.accuracy_m());
  }
  text += fmt::format(", {} frames of {} access points",
                      location.quality().frames(),
                      location.quality().access_points());
  text += location.quality().ambiguous() ? ", ambiguous" : "";
  for (const std::string& warning : location.quality().warnings()) {
    text += "; warning: " + warning;
  }
  return text;
}

std::string describe(const v1::Heartbeat& heartbeat) {
  std::uint64_t received = 0;
  std::uint64_t lost = 0;
  std::uint64_t frames_lost = 0;
  for (const v1::SourceReport& source : heartbeat.sources()) {
    received += source.counters().received();
    lost += source.counters().kernel_drops() + source.counters().ring_dropped();
    frames_lost += source.counters().frames_dropped();
  }
  return fmt::format(
      "heartbeat  {} datagrams received, {} dropped, {} frames dropped, {} fixes, "
      "{} subscriptions",
      received,
      lost,
      frames_lost,
      heartbeat.estimation().fixes(),
      heartbeat.publisher().subscriptions());
}

std::string describe(const v1::SourceState& source) {
  return fmt::format("source     {} {}: {} datagrams received{}{}",
                     source.access_point(),
                     enum_word(v1::SourceStatus_Name(source.status()), 14),
                     source.counters().received(),
                     source.detail().empty() ? "" : ": ",
                     source.detail());
}

std::string describe(const v1::ZoneEvent& event) {
  std::string text = fmt::format("zone       {} {} {}",
                                 name_of(event.target()),
                                 enum_word(v1::ZoneEventKind_Name(event.kind()), 16),
                                 event.zone());
  if (event.has_dwell()) {
    text += fmt::format(" after {:.1f} s", to_seconds(from_proto(event.dwell())));
  }
  text += fmt::format(", {} inside", event.occupancy());
  return text + (event.reason().empty() ? "" : ": " + event.reason());
}

std::string describe(const v1::Envelope& envelope) {
  switch (envelope.body_case()) {
    case v1::Envelope::kLocation:
      return describe(envelope.location());
    case v1::Envelope::kCompared:
      return describe(envelope.compared(), "compared") + ", by " +
             envelope.compared().quality().method();
    case v1::Envelope::kTrack:
      return fmt::format("track      {} {}: {}",
                         name_of(envelope.track().target()),
                         enum_word(v1::TrackState_Name(envelope.track().state()), 12),
                         envelope.track().reason());
    case v1::Envelope::kZone:
      return describe(envelope.zone());
    case v1::Envelope::kSource:
      return describe(envelope.source());
    case v1::Envelope::kHeartbeat:
      return describe(envelope.heartbeat());
    case v1::Envelope::kCsi:
      return fmt::format("csi        {} {} {} MHz, {} tones",
                         envelope.csi().ap(),
                         envelope.csi().transmitter(),
                         envelope.csi().bandwidth_mhz(),
                         envelope.csi().tone_index_size());
    case v1::Envelope::kGoodbye:
      return "goodbye    " + envelope.goodbye().reason();
    case v1::Envelope::BODY_NOT_SET:
      return "unknown    (of a later version?)";
  }
  return {};
}

}  // namespace

std::string message_line(const v1::Envelope& envelope) {
  return printable(time_of_day(envelope.sent()) + "  " + describe(envelope));
}

}  // namespace rayloc::cli
