// Files that a pattern names, as a shell would expand it: glob(7).
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

// Of a path without wildcards itself, if it is there.
FileMatches match_files(const std::filesystem::path& pattern);

}  // namespace rayloc
