#include "daemon/cli/verbs/report/replay_files.h"

#include <utility>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/delimited_message_util.h>

#include "daemon/lab/replay/warm_replay.h"
#include "daemon/messages/json.h"

namespace rayloc::cli {
namespace {

// Returns empty if the file has no name.
Expected<std::optional<OutputFile>> open_optional(const std::string& file) {
  if (file.empty()) {
    return std::optional<OutputFile>();
  }
  Expected<OutputFile> opened = OutputFile::open(file);
  RAYLOC_TRY(opened);
  return std::optional<OutputFile>(std::move(*opened));
}

}  // namespace

ReplayFiles::ReplayFiles(bool is_binary,
                         OutputFile locations,
                         std::optional<OutputFile> events,
                         std::optional<OutputFile> carried)
    : is_binary_(is_binary),
      locations_(std::move(locations)),
      events_(std::move(events)),
      carried_(std::move(carried)) {}

Expected<ReplayFiles> ReplayFiles::open(const std::string& format, const Paths& paths) {
  Expected<OutputFile> locations = OutputFile::open(paths.locations);
  RAYLOC_TRY(locations);
  auto events = open_optional(paths.zone_events);
  auto carried = open_optional(paths.carried);
  RAYLOC_TRY(events);
  RAYLOC_TRY(carried);
  return ReplayFiles(
      format == "pb", *std::move(locations), *std::move(events), *std::move(carried));
}

// Our own messages always have a JSON form.
void ReplayFiles::write(const google::protobuf::Message& message, OutputFile& out) const {
  if (is_binary_) {
    std::string bytes;
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::util::SerializeDelimitedToZeroCopyStream(message, &stream);
    out.write(bytes);
  } else {
    out.write(to_json(message).value() + "\n");
  }
}

void ReplayFiles::write_location(const google::protobuf::Message& location) {
  write(location, locations_);
}

void ReplayFiles::write_event(const google::protobuf::Message& event) {
  if (events_) {
    write(event, *events_);
  }
}

void ReplayFiles::write_carried(const Carried& carried) {
  if (carried_) {
    carried_->write(replay::carried_line(carried));
  }
}

Expected<void> ReplayFiles::close() {
  for (OutputFile* const file :
       {&locations_, events_ ? &*events_ : nullptr, carried_ ? &*carried_ : nullptr}) {
    if (file != nullptr) {
      RAYLOC_TRY(file->close());
    }
  }
  return {};
}

}  // namespace rayloc::cli
