// ReplayFiles: the files that `rayloc replay` writes, in JSON lines or varint-delimited protobuf.
#pragma once

#include <optional>
#include <string>

#include <google/protobuf/message.h>

#include "daemon/base/output_file.h"
#include "daemon/pipeline/warm/carried.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

class ReplayFiles {
 public:
  struct Paths {
    std::string locations;     // "-" is standard output
    std::string zone_events;   // empty: not written
    std::string carried = {};  // empty: not written
  };

  // `format`: "jsonl" or "pb". An Error if a file cannot be opened.
  static Expected<ReplayFiles> open(const std::string& format, const Paths& paths);

  void write_location(const google::protobuf::Message& location);
  void write_event(const google::protobuf::Message& event);
  void write_carried(const Carried& carried);  // always JSON lines
  // An Error if anything could not be written.
  Expected<void> close();

 private:
  ReplayFiles(bool is_binary,
              OutputFile locations,
              std::optional<OutputFile> events,
              std::optional<OutputFile> carried);
  void write(const google::protobuf::Message& message, OutputFile& out) const;

  bool is_binary_;
  OutputFile locations_;
  std::optional<OutputFile> events_;
  std::optional<OutputFile> carried_;
};

}  // namespace rayloc::cli
