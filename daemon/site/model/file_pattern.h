// Files that match a pattern, expanded as by a shell: glob(7).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rayloc {

bool has_wildcard(std::string_view pattern);

struct FileMatches {
  std::vector<std::filesystem::path> files;  // sorted
  // Folders whose files cannot be listed, each with the reason.
  std::vector<std::string> unreadable;
};

// A path without wildcards matches itself, if it exists.
FileMatches match_files(const std::filesystem::path& pattern);

}  // namespace rayloc
