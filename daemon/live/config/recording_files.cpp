#include "daemon/live/config/recording_files.h"

#include <system_error>

#include "daemon/site/model/file_pattern.h"

namespace rayloc {

std::vector<std::string> recording_files(const SourceConfig& source) {
  std::vector<std::string> files;
  for (const std::filesystem::path& pattern : source.files) {
    std::error_code unknown;
    const bool expand =
        has_wildcard(pattern.native()) && !std::filesystem::exists(pattern, unknown);
    const FileMatches found = expand ? match_files(pattern) : FileMatches{};
    if (found.files.empty()) {
      files.push_back(pattern.string());
    }
    for (const std::filesystem::path& file : found.files) {
      files.push_back(file.string());
    }
  }
  return files;
}

}  // namespace rayloc
