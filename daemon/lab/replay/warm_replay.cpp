#include "daemon/lab/replay/warm_replay.h"

#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include <google/protobuf/util/time_util.h>

#include "daemon/messages/json.h"
#include "daemon/messages/proto_time.h"
#include "daemon/pipeline/output/carried_message.h"

namespace rayloc::replay {
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

Expected<WarmStart> warm_start_of(const WarmOptions& replay) {
  const auto from = parse_from(replay.from);
  RAYLOC_TRY(from);
  std::vector<Carried> records;
  if (!replay.carried.empty()) {
    auto read = read_records(replay.carried);
    RAYLOC_TRY(read);
    records = *std::move(read);
  }
  auto start = warm_start(records, *from, replay.warm_up);
  if (!start) {
    return bad_input(replay.carried + ": " + start.error().message + " than --from " + replay.from);
  }
  return start;
}

std::string carried_line(const Carried& carried) {
  return to_json(carried_message(carried)).value() + "\n";
}

}  // namespace rayloc::replay
