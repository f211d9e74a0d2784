#include "daemon/cli/verbs/warm_replay.h"

#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include <google/protobuf/util/time_util.h>

#include "daemon/messages/json.h"
#include "daemon/messages/proto_time.h"
#include "daemon/pipeline/output/carried_message.h"

namespace rayloc::cli {
namespace {

Expected<std::optional<Timestamp>> parse_from(const std::string& text) {
  if (text.empty()) {
    return std::optional<Timestamp>();
  }
  google::protobuf::Timestamp time;
  if (!google::protobuf::util::TimeUtil::FromString(text, &time)) {
    return make_error(ErrorKind::kUsage,
                      "--from " + text + ": write a time as in locations: 2024-06-10T06:13:35.5Z");
  }
  return std::optional<Timestamp>(from_proto(time));
}

Expected<std::vector<Carried>> read_records(const std::string& file) {
  std::ifstream in(file);
  if (!in.is_open()) {
    return bad_input(file + ": cannot be read");
  }
  std::vector<Carried> records;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    const std::string place = file + ":" + std::to_string(++number) + ": ";
    v1::Carried message;
    if (const auto read = from_json(line, message); !read) {
      return bad_input(place + "no record of --carried-out: " + read.error().message);
    }
    auto carried = carried_of(message);
    if (!carried) {
      return bad_input(place + carried.error().message);
    }
    records.push_back(*std::move(carried));
  }
  if (records.empty()) {
    return bad_input(file + ": holds no record; the recording that made it is too short");
  }
  return records;
}

}  // namespace

void add_warm_replay_options(OptionParser& app, WarmReplayArguments& arguments) {
  app.add_option(
      "--from",
      arguments.from,
      "write no results of instants before this time, as in locations: 2024-06-10T06:13:35.5Z");
  app.add_option("--warm-up",
                 arguments.warm_up,
                 "seconds before that from which frames are processed, without results")
      ->check(in_range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--carried",
                 arguments.carried,
                 "file of --carried-out: go on with its bursts, numbers and stays in zones, as if "
                 "there had been no break; without --from, from the last record on");
  app.add_option("--carried-out",
                 arguments.carried_out,
                 "file for what a replay needs that is to go on from there, a record a line");
  app.add_option("--carried-every",
                 arguments.carried_every,
                 "seconds of the recording from one record to the next")
      ->check(in_range(0.01, 3600.0))
      ->capture_default_str();
}

Expected<WarmStart> warm_start_of(const WarmReplayArguments& arguments) {
  const auto from = parse_from(arguments.from);
  if (!from) {
    return tl::make_unexpected(from.error());
  }
  std::vector<Carried> records;
  if (!arguments.carried.empty()) {
    auto read = read_records(arguments.carried);
    if (!read) {
      return tl::make_unexpected(std::move(read.error()));
    }
    records = *std::move(read);
  }
  auto start = warm_start(records, *from, from_seconds(arguments.warm_up));
  if (!start) {
    return bad_input(arguments.carried + ": " + start.error().message + " than --from " +
                     arguments.from);
  }
  return start;
}

std::string carried_line(const Carried& carried) {
  return to_json(carried_message(carried)).value() + "\n";
}

}  // namespace rayloc::cli
