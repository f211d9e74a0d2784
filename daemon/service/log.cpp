#include "daemon/service/log.h"

#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

// Every entry would have the place in log_event() as its own otherwise.
#define SD_JOURNAL_SUPPRESS_LOCATION
#include <systemd/sd-journal.h>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/systemd_sink.h>
#include <spdlog/spdlog.h>

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

// systemd.exec(5): $JOURNAL_STREAM is the device and inode of the stream to the journal. A program
// that hands it on and connects standard error to something else wants the log there.
bool is_journal_stream(int fd) {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  return stream != nullptr && fstat(fd, &status) == 0 &&
         stream == std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

bool to_journal() {
  static const bool kConnected = is_journal_stream(STDERR_FILENO);
  return kConnected;
}

// As syslog(3) counts them.
const char* priority(LogLevel level) {
  switch (level) {
    case LogLevel::kTrace:
    case LogLevel::kDebug:
      return "7";
    case LogLevel::kInfo:
      return "6";
    case LogLevel::kWarning:
      return "4";
    case LogLevel::kError:
      return "3";
  }
  return "6";
}

// False when the journal is away.
bool send_to_journal(const LogEvent& event) {
  std::vector<std::string> entries = {"MESSAGE=" + event.message,
                                      std::string("PRIORITY=") + priority(event.level),
                                      "SYSLOG_IDENTIFIER=raylocd"};
  for (const LogField& field : event.fields) {
    std::string name = "RAYLOC_";
    for (const char c : field.name) {
      name += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    entries.push_back(name + "=" + field.value);
  }
  std::vector<iovec> parts;
  parts.reserve(entries.size());
  for (std::string& entry : entries) {
    parts.push_back({entry.data(), entry.size()});
  }
  return sd_journal_sendv(parts.data(), static_cast<int>(parts.size())) == 0;
}

std::shared_ptr<spdlog::logger> journal_or_stderr() {
  if (to_journal()) {
    auto sink = std::make_shared<spdlog::sinks::systemd_sink_mt>("raylocd");
    return std::make_shared<spdlog::logger>("raylocd", std::move(sink));
  }
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  auto logger = std::make_shared<spdlog::logger>("raylocd", std::move(sink));
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %^%l%$ %v", spdlog::pattern_time_type::utc);
  return logger;
}

}  // namespace

void set_up_log(const LogConfig& config) {
  std::shared_ptr<spdlog::logger> logger = journal_or_stderr();
  // The journal may be away while it is restarted: no reason to end.
  logger->set_error_handler(
      [](const std::string& why) { std::fprintf(stderr, "raylocd: log: %s\n", why.c_str()); });
  spdlog::set_default_logger(std::move(logger));
  set_log_level(config);
}

void log_event(const LogEvent& event) {
  const spdlog::level::level_enum level = spdlog_level(event.level);
  if (!spdlog::should_log(level) || (to_journal() && send_to_journal(event))) {
    return;
  }
  std::string line = event.message;
  for (const LogField& field : event.fields) {
    line += " " + field.name + "=" + field.value;
  }
  spdlog::log(level, "{}", line);
}

void set_log_level(const LogConfig& config) {
  spdlog::default_logger()->set_level(spdlog_level(config.level));
}

}  // namespace rayloc
