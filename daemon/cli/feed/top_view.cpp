#include "daemon/cli/feed/top_view.h"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/cli/feed/age_text.h"
#include "daemon/cli/terminal/text_table.h"
#include "daemon/messages/proto_time.h"
#include "daemon/messages/topic.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

using Lines = std::vector<std::string>;
using Now = TopModel::Clock::time_point;

constexpr auto kSilentAfter = std::chrono::seconds(3);

std::string without_enum_prefix(const std::string& name, std::string_view prefix) {
  std::string text;
  for (const char c : name.substr(std::min(prefix.size(), name.size()))) {
    text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return text;
}

void append(const TextTable& table, std::size_t width, Lines& lines) {
  if (table.rows() > 0) {
    lines.emplace_back();
    for (std::string& line : table.lines(width)) {
      lines.push_back(std::move(line));
    }
  }
}

// "core 0 rotated by 173 degrees +- 5, core 3 rotated by 113 degrees +- 6"
std::string turns_text(const v1::ChainReport& chains) {
  std::string text;
  for (const v1::ChainTurn& turn : chains.turns()) {
    text += fmt::format("{}core {} rotated by {:.0f} degrees +- {:.0f}",
                        text.empty() ? "" : ", ",
                        turn.core(),
                        turn.phase_deg(),
                        turn.phase_sigma_deg());
  }
  return text;
}

void add_daemon(const TopModel& model, Now now, Lines& lines) {
  if (!model.heartbeat()) {
    lines.emplace_back("no heartbeat yet");
    return;
  }
  const v1::Heartbeat& heartbeat = *model.heartbeat();
  const double up = to_seconds(model.daemon_time(now) - from_proto(heartbeat.started()));
  std::string state;
  if (model.goodbye()) {
    state = "stopped: " + model.goodbye()->reason();
  } else if (const auto silence = model.silence(now); *silence > kSilentAfter) {
    state = "NO HEARTBEAT FOR " + age_text(std::chrono::duration<double>(*silence).count());
  } else {
    state = "up " + age_text(up);
  }
  lines.push_back(
      fmt::format("raylocd {}  {}  {} targets, {} messages lost on the way, {} restarts",
                  heartbeat.software_version(),
                  state,
                  model.targets().size(),
                  model.lost(),
                  model.restarts()));
  for (const auto* warnings : {&heartbeat.warnings(), &heartbeat.calibration_warnings()}) {
    for (const std::string& warning : *warnings) {
      lines.push_back("warning: " + warning);
    }
  }
  for (const v1::ChainReport& chains : heartbeat.chains()) {
    if (chains.knowledge() == v1::CHAIN_KNOWLEDGE_LEARNED) {
      lines.push_back("chains of " + chains.access_point() + " learned: " + turns_text(chains));
    }
  }
}

std::string accuracy_text(const v1::Location& location) {
  return location.has_accuracy_m() ? fmt::format("{:.2f} m {:.0f} %",
                                                 location.accuracy_m(),
                                                 100.0 * location.accuracy_confidence())
                                   : "-";
}

std::string zones_text(const TopModel& model, const std::string& component) {
  std::string text;
  for (const std::string& zone : model.zones_of(component)) {
    text += (text.empty() ? "" : " ") + zone;
  }
  return text;
}

void add_targets(const TopModel& model, Now now, std::size_t width, Lines& lines) {
  TextTable table({"target",
                   "name",
                   "kind",
                   "mode",
                   ">x",
                   ">y",
                   ">z",
                   ">accuracy",
                   ">age",
                   ">1/s",
                   "state",
                   "zones"});
  table.may_lack({"z", "mode", "1/s", "kind", "name", "state", "age", "zones"});
  for (const auto& [component, target] : model.targets()) {
    const TopModel::Stream& stream = TopModel::shown(target);
    const v1::Location& location = stream.last;
    const auto coordinate = [&](double value) {
      return location.has_position() ? fmt::format("{:.2f}", value) : "-";
    };
    const bool is_fix = location.mode() != v1::FIX_MODE_NO_FIX;
    table.add(
        {component,
         location.target().name(),
         without_enum_prefix(v1::LocationKind_Name(location.kind()), "LOCATION_KIND_"),
         without_enum_prefix(v1::FixMode_Name(location.mode()), "FIX_MODE_"),
         coordinate(location.position().x()),
         coordinate(location.position().y()),
         coordinate(location.position().z()),
         accuracy_text(location),
         age_text(to_seconds(model.daemon_time(now) - stream.sent)),
         fmt::format("{:.1f}", TopModel::rate(stream, now)),
         location.track_state() == v1::TRACK_STATE_UNSPECIFIED
             ? "-"
             : without_enum_prefix(v1::TrackState_Name(location.track_state()), "TRACK_STATE_"),
         is_fix ? zones_text(model, component) : location.quality().no_fix_reason()});
  }
  append(table, width, lines);
}

// Adds warnings for the positions shown, and reasons why a source delivers no data.
void add_reasons(const TopModel& model, Lines& lines) {
  Lines reasons;
  for (const auto& [component, target] : model.targets()) {
    const v1::Location& location = TopModel::shown(target).last;
    const std::string name =
        location.target().name().empty() ? component : location.target().name();
    for (const std::string& warning : location.quality().warnings()) {
      reasons.push_back(fmt::format("warning: {}: {}", name, warning));
    }
    if (location.quality().ambiguous()) {
      reasons.push_back(fmt::format("warning: {}: another place is nearly as likely", name));
    }
  }
  for (const auto& [access_point, source] : model.sources()) {
    const std::string status =
        without_enum_prefix(v1::SourceStatus_Name(source.status()), "SOURCE_STATUS_");
    if (!source.detail().empty()) {
      reasons.push_back(fmt::format("{} {}: {}", access_point, status, source.detail()));
    }
  }
  if (!reasons.empty()) {
    lines.emplace_back();
    lines.insert(lines.end(), reasons.begin(), reasons.end());
  }
}

void add_zones(const TopModel& model, std::size_t width, Lines& lines) {
  TextTable table({"zone", ">inside", "who"});
  for (const auto& [name, event] : model.zones()) {
    std::string who;
    for (const v1::Target& target : event.inside()) {
      who += (who.empty() ? "" : " ") +
             (target.name().empty() ? target_component(target) : target.name());
    }
    table.add({name, std::to_string(event.occupancy()), who});
  }
  append(table, width, lines);
}

// Datagrams and frames that were received or in transit and are in no estimate, as on the live
// map (daemon/live/http/ROUTES.md). Rejected datagrams and partial frames are counted separately.
std::uint64_t lost_of(const v1::SourceCounters& counters) {
  return counters.kernel_drops() + counters.ring_dropped() + counters.late() +
         counters.frames_dropped();
}

void add_sources(const TopModel& model, std::size_t width, Lines& lines) {
  TextTable table({"access point",
                   "status",
                   ">datagrams",
                   ">1/s",
                   ">frames",
                   ">partial",
                   ">rejected",
                   ">lost",
                   ">age"});
  table.may_lack({"age", "datagrams", "frames", "rejected", "partial"});
  for (const v1::SourceReport& source : model.heartbeat()->sources()) {
    const v1::SourceCounters& counters = source.counters();
    std::uint64_t rejected = 0;
    for (const auto& [reason, count] : counters.rejected()) {
      rejected += count;
    }
    const auto rate = model.datagram_rate(source.access_point());
    table.add({source.access_point(),
               without_enum_prefix(v1::SourceStatus_Name(source.status()), "SOURCE_STATUS_"),
               std::to_string(counters.received()),
               rate ? fmt::format("{:.0f}", *rate) : "-",
               std::to_string(counters.frames_complete() + counters.frames_partial()),
               std::to_string(counters.frames_partial()),
               std::to_string(rejected),
               std::to_string(lost_of(counters)),
               source.has_age() ? age_text(to_seconds(from_proto(source.age()))) : "-"});
  }
  append(table, width, lines);
}

void add_counters(const v1::Heartbeat& heartbeat, Lines& lines) {
  const v1::EstimationCounters& estimation = heartbeat.estimation();
  const v1::TrackerCounters& tracker = heartbeat.tracker();
  const v1::PublisherCounters& publisher = heartbeat.publisher();
  lines.emplace_back();
  lines.push_back(
      fmt::format("estimation  {} fixes, {} without a position, {} filtered; {} bursts merged, "
                  "{} dropped, {} waiting",
                  estimation.fixes(),
                  estimation.no_fixes(),
                  estimation.filtered(),
                  estimation.bursts_merged(),
                  estimation.bursts_dropped(),
                  estimation.bursts_in_flight()));
  lines.push_back(fmt::format(
      "tracks      {} now, {} begun, {} lost", tracker.tracks(), tracker.begun(), tracker.lost()));
  if (heartbeat.has_person_tracker()) {
    const v1::PersonTrackerCounters& people = heartbeat.person_tracker();
    lines.push_back(fmt::format("people      {} now, {} begun, {} lost; seen in {} of {} moments",
                                people.tracks(),
                                people.begun(),
                                people.lost(),
                                people.used(),
                                people.moments()));
  }
  lines.push_back(
      fmt::format("publisher   {} messages to {} subscriptions; {} coalesced, {} events dropped, "
                  "{} times a subscriber was slow",
                  publisher.published(),
                  publisher.subscriptions(),
                  estimation.coalesced(),
                  estimation.events_dropped(),
                  publisher.slow_episodes()));
  if (heartbeat.has_recorder()) {
    lines.push_back(fmt::format("recorder    {} datagrams written, {} dropped",
                                heartbeat.recorder().written(),
                                heartbeat.recorder().dropped()));
  }
}

}  // namespace

std::vector<std::string> top_lines(const TopModel& model, Now now, std::size_t width) {
  constexpr std::size_t kIndent = 12;  // as in the text of the counters
  Lines sentences;
  add_daemon(model, now, sentences);
  Lines counters;
  Lines tables;
  add_targets(model, now, width, tables);
  add_zones(model, width, tables);
  if (model.heartbeat()) {
    add_sources(model, width, tables);
  }
  add_reasons(model, counters);
  if (model.heartbeat()) {
    add_counters(*model.heartbeat(), counters);
  }
  Lines lines;
  const auto append_wrapped = [&](const Lines& texts) {
    for (const std::string& text : texts) {
      for (std::string& line : wrapped(text, width, kIndent)) {
        lines.push_back(std::move(line));
      }
    }
  };
  append_wrapped(sentences);
  lines.insert(lines.end(), tables.begin(), tables.end());
  append_wrapped(counters);
  for (std::string& line : lines) {
    line = printable(std::move(line));
  }
  return lines;
}

}  // namespace rayloc::cli
