#include "daemon/live/cluster/operate/stream_admin.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <iomanip>
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

namespace rayloc {
namespace {

using nlohmann::json;

// Returns the reply of JetStream, or its error message.
Expected<json> answer_of(Broker& broker, const std::string& subject, const json& question) {
  const auto reply = broker.ask("$JS.API." + subject, question.dump());
  RAYLOC_TRY(reply);
  json answer = json::parse(*reply, nullptr, false);
  if (!answer.is_object()) {
    return make_error(ErrorKind::kUnavailable, subject + ": the server's answer is no JSON");
  }
  if (const auto error = answer.find("error"); error != answer.end()) {
    return make_error(ErrorKind::kUnavailable,
                      subject + ": " + error->value("description", std::string("an error")));
  }
  return answer;
}

StreamReport report_of(const json& stream) {
  StreamReport report;
  const json config = stream.value("config", json::object());
  report.options.name = config.value("name", "");
  report.options.in_memory = config.value("storage", "") == "memory";
  report.options.replicas = config.value("num_replicas", 1);
  report.options.max_age = std::chrono::duration_cast<std::chrono::seconds>(
      std::chrono::nanoseconds(config.value("max_age", std::int64_t{0})));
  report.options.max_messages_per_subject =
      std::max(config.value("max_msgs_per_subject", std::int64_t{0}), std::int64_t{0});  // -1: any
  report.options.republish_to =
      config.value("republish", json::object()).value("dest", std::string());
  report.answers_directly = config.value("allow_direct", false);
  report.bytes = stream.value("state", json::object()).value("bytes", std::uint64_t{0});
  const json cluster = stream.value("cluster", json::object());
  if (!cluster.is_object()) {
    return report;
  }
  if (!cluster.empty() && cluster.value("leader", "").empty()) {
    report.troubles.emplace_back("no leader");
  }
  for (const json& replica : cluster.value("replicas", json::array())) {
    const std::string name = replica.value("name", "");
    if (replica.value("offline", false)) {
      report.troubles.push_back(name + " is offline");
    } else if (!replica.value("current", true)) {
      report.troubles.push_back(name + " is behind by " +
                                std::to_string(replica.value("lag", std::uint64_t{0})) +
                                " messages");
    }
  }
  return report;
}

// Parses RFC 3339, in UTC as servers write it; nothing for other text.
std::optional<Timestamp> time_of(const std::string& text) {
  std::tm parts{};
  std::istringstream in(text);
  in >> std::get_time(&parts, "%Y-%m-%dT%H:%M:%S");
  if (in.fail()) {
    return std::nullopt;
  }
  const std::chrono::seconds whole(::timegm(&parts));
  double fraction = 0.0;
  if (in.peek() == '.') {
    in >> fraction;
  }
  return Timestamp(whole) + from_seconds(fraction);
}

}  // namespace

Expected<std::vector<std::string>> subjects_of(Broker& broker, const std::string& stream) {
  std::vector<std::string> subjects;
  // The server returns so many at once that there is one page, as a rule.
  for (;;) {
    const auto answer = answer_of(
        broker, "STREAM.INFO." + stream, {{"subjects_filter", ">"}, {"offset", subjects.size()}});
    RAYLOC_TRY(answer);
    const json state = answer->value("state", json::object());
    const json page = state.value("subjects", json::object());
    for (const auto& [subject, messages] : page.items()) {
      subjects.push_back(subject);
    }
    if (page.empty() || subjects.size() >= answer->value("total", std::size_t{0})) {
      return subjects;
    }
  }
}

Expected<void> forget_subjects(Broker& broker,
                               const std::string& stream,
                               const std::string& subjects) {
  const auto answer = answer_of(broker, "STREAM.PURGE." + stream, {{"filter", subjects}});
  return answer ? Expected<void>() : tl::make_unexpected(answer.error());
}

Expected<void> forget_stream(Broker& broker, const std::string& stream) {
  const auto streams = streams_of(broker);
  RAYLOC_TRY(streams);
  if (std::none_of(streams->begin(), streams->end(), [&](const StreamReport& one) {
        return one.options.name == stream;
      })) {
    return {};
  }
  const auto answer = answer_of(broker, "STREAM.DELETE." + stream, json::object());
  return answer ? Expected<void>() : tl::make_unexpected(answer.error());
}

Expected<std::vector<StreamReport>> streams_of(Broker& broker) {
  std::vector<StreamReport> streams;
  for (;;) {
    const auto answer = answer_of(broker, "STREAM.LIST", {{"offset", streams.size()}});
    RAYLOC_TRY(answer);
    const json page = answer->value("streams", json::array());
    if (!page.is_array()) {  // null: no streams
      return streams;
    }
    for (const json& stream : page) {
      streams.push_back(report_of(stream));
    }
    if (page.empty() || streams.size() >= answer->value("total", std::size_t{0})) {
      return streams;
    }
  }
}

Expected<StoreReport> store_of(Broker& broker) {
  const auto answer = answer_of(broker, "INFO", json::object());
  RAYLOC_TRY(answer);
  const json limits = answer->value("limits", json::object());
  return StoreReport{answer->value("memory", std::uint64_t{0}),
                     answer->value("storage", std::uint64_t{0}),
                     limits.value("max_memory", std::int64_t{-1}),
                     limits.value("max_storage", std::int64_t{-1})};
}

Expected<std::optional<Timestamp>> last_stored(Broker& broker,
                                               const std::string& stream,
                                               const std::string& subject) {
  const auto answer = answer_of(broker, "STREAM.MSG.GET." + stream, {{"last_by_subj", subject}});
  RAYLOC_TRY(answer);
  return time_of(answer->value("message", json::object()).value("time", ""));
}

}  // namespace rayloc
