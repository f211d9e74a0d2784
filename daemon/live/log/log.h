// The log of raylocd: to the journal with its levels and fields where standard error is the
// journal's, otherwise to standard error, one line each, with time (UTC) and level. It is written
// in the background (background_log.h): spdlog's flush() waits for that, a second at most.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/live/config/config.h"

namespace rayloc {

// Becomes spdlog's default logger.
void set_up_log(const LogConfig& config);
void set_log_level(const LogConfig& config);

// A figure of an event that a program may need: the journal stores it as a separate field
// (RAYLOC_SOURCE=ap1, for `journalctl RAYLOC_SOURCE=ap1`), a line of text has it at its end ("...
// source=ap1").
struct LogField {
  std::string name;  // lower case, digits and '_'
  std::string value;
};
struct LogEvent {
  LogLevel level = LogLevel::kInfo;
  std::string message;
  std::vector<LogField> fields = {};
};
void log_event(const LogEvent& event);
// A line without figures.
inline void log_line(LogLevel level, const std::string& text) { log_event({level, text}); }

// Number of entries that were dropped because they were not written in time.
std::uint64_t log_entries_dropped();

}  // namespace rayloc
