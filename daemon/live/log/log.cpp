#include "daemon/live/log/log.h"

#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

// Otherwise every entry would have its place in log_event().
#define SD_JOURNAL_SUPPRESS_LOCATION
#include <systemd/sd-journal.h>

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "daemon/live/log/background_log.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

spdlog::level::level_enum spdlog_level(LogLevel level) {
  switch (level) {
    case LogLevel::kTrace:
      return spdlog::level::trace;
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

// systemd.exec(5): $JOURNAL_STREAM is the device and inode of the stream to the journal. If a
// parent process passes it on but redirects standard error, the log is to go to standard error.
bool is_journal_stream(int fd) {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  return stream != nullptr && fstat(fd, &status) == 0 &&
         stream == std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

// Numbers of syslog(3).
const char* priority(spdlog::level::level_enum level) {
  switch (level) {
    case spdlog::level::trace:
    case spdlog::level::debug:
      return "7";
    case spdlog::level::warn:
      return "4";
    case spdlog::level::err:
      return "3";
    case spdlog::level::critical:
      return "2";
    default:
      return "6";
  }
}

// Text that entries quote from files and from the network must not control a terminal. Line breaks
// of an entry come from our own code; log_event() takes one line.
std::string line_of(const LogEntry& entry) {
  std::string line = printable(entry.message, '\n');
  for (const LogField& field : entry.fields) {
    line += " " + field.name + "=" + printable(field.value);
  }
  return line;
}

void write_to_journal(const LogEntry& entry) {
  std::vector<std::string> entries = {"MESSAGE=" + printable(entry.message, '\n'),
                                      std::string("PRIORITY=") + priority(entry.level),
                                      "SYSLOG_IDENTIFIER=raylocd"};
  for (const LogField& field : entry.fields) {
    std::string name = "RAYLOC_";
    for (const char c : field.name) {
      name += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    entries.push_back(name + "=" + printable(field.value));
  }
  std::vector<iovec> parts;
  parts.reserve(entries.size());
  for (std::string& part : entries) {
    parts.push_back({part.data(), part.size()});
  }
  // The journal may be absent during a restart; systemd keeps its stream open.
  if (sd_journal_sendv(parts.data(), static_cast<int>(parts.size())) != 0) {
    std::fprintf(stderr, "%s\n", line_of(entry).c_str());
  }
}

BackgroundLog::Write to_stderr() {
  const auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_st>();
  sink->set_formatter(std::make_unique<spdlog::pattern_formatter>("%Y-%m-%dT%H:%M:%S.%eZ %^%l%$ %v",
                                                                  spdlog::pattern_time_type::utc));
  return [sink](const LogEntry& entry) {
    const std::string line = line_of(entry);
    sink->log(spdlog::details::log_msg(entry.time, {}, "raylocd", entry.level, line));
  };
}

// Passes all spdlog messages to the background log.
class BackgroundSink final : public spdlog::sinks::sink {
 public:
  explicit BackgroundSink(BackgroundLog::Write write) : log_(std::move(write)) {}

  void log(const spdlog::details::log_msg& message) override {
    log_.put({message.level, message.time, {message.payload.data(), message.payload.size()}});
  }
  void flush() override { log_.flush(); }
  void set_pattern(const std::string& /*pattern*/) override {}
  void set_formatter(std::unique_ptr<spdlog::formatter> /*formatter*/) override {}

  BackgroundLog& background() { return log_; }

 private:
  BackgroundLog log_;
};

// Null before set_up_log().
BackgroundLog* background_log() {
  for (const spdlog::sink_ptr& sink : spdlog::default_logger_raw()->sinks()) {
    if (auto* const background = dynamic_cast<BackgroundSink*>(sink.get()); background != nullptr) {
      return &background->background();
    }
  }
  return nullptr;
}

}  // namespace

void set_up_log(const LogConfig& config) {
  auto sink = std::make_shared<BackgroundSink>(
      is_journal_stream(STDERR_FILENO) ? BackgroundLog::Write(write_to_journal) : to_stderr());
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("raylocd", std::move(sink)));
  set_log_level(config);
}

void log_event(const LogEvent& event) {
  const spdlog::level::level_enum level = spdlog_level(event.level);
  if (!spdlog::should_log(level)) {
    return;
  }
  LogEntry entry{level, std::chrono::system_clock::now(), printable(event.message), event.fields};
  if (BackgroundLog* const background = background_log(); background != nullptr) {
    background->put(std::move(entry));
  } else {
    spdlog::log(level, "{}", line_of(entry));
  }
}

std::uint64_t log_entries_dropped() {
  const BackgroundLog* const background = background_log();
  return background != nullptr ? background->dropped() : 0;
}

void set_log_level(const LogConfig& config) {
  spdlog::default_logger()->set_level(spdlog_level(config.level));
}

}  // namespace rayloc
