// LossWatch: logs losses, from the counters of the heartbeat: the first loss of a kind immediately,
// further ones by LimitedLog. Thread safety: one thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "daemon/live/log/limited_log.h"
#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc {

class LossWatch {
 public:
  // `label`: prefix of the lines, "site 'office': ", where there are several sites.
  explicit LossWatch(std::shared_ptr<LimitedLog> log, std::string label = {})
      : log_(std::move(log)), label_(std::move(label)) {}

  // For a site; to be called about every second with the current counters.
  void check(const v1::Heartbeat& heartbeat);
  // The same for the counters that all sites share (shared_counters() in status.h), and the log's.
  void check_shared(const v1::Heartbeat& shared, std::uint64_t log_dropped);

 private:
  struct Loss {
    std::string kind;  // "kernel_drops"
    std::string what;  // description in words
    std::string source = {};
  };
  void compare(const Loss& loss, std::uint64_t count);
  void check_source(const v1::SourceReport& source);
  void check_stream(const v1::StreamCounters& stream);

  const std::shared_ptr<LimitedLog> log_;
  const std::string label_;
  std::map<std::string, std::uint64_t> seen_;  // by kind and source
};

}  // namespace rayloc
