#include "daemon/live/machine/running_daemon.h"

#include <charconv>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

namespace rayloc {
namespace {

namespace fs = std::filesystem;

std::string read_all(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// The value of --config; empty without.
std::string configuration_of(const std::string& command_line) {
  const std::string option = "--config";
  std::vector<std::string> words;
  for (std::size_t at = 0; at < command_line.size(); at = command_line.find('\0', at) + 1) {
    words.emplace_back(command_line.c_str() + at);
    if (command_line.find('\0', at) == std::string::npos) {
      break;
    }
  }
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == option && i + 1 < words.size()) {
      return words[i + 1];
    }
    if (words[i].rfind(option + "=", 0) == 0) {
      return words[i].substr(option.size() + 1);
    }
  }
  return {};
}

}  // namespace

std::optional<pid_t> running_daemon(const fs::path& configuration) {
  std::error_code failed;
  for (fs::directory_iterator entry("/proc", failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    pid_t pid = 0;
    const auto [rest, bad] = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (bad != std::errc() || rest != name.data() + name.size() ||
        read_all(entry->path() / "comm") != "raylocd\n") {
      continue;
    }
    const fs::path stated = configuration_of(read_all(entry->path() / "cmdline"));
    std::error_code unknown;
    if (!stated.empty() && fs::equivalent(entry->path() / "cwd" / stated, configuration, unknown)) {
      return pid;
    }
  }
  return std::nullopt;
}

}  // namespace rayloc
