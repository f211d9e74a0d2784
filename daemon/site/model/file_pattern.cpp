#include "daemon/site/model/file_pattern.h"

#include <glob.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace rayloc {
namespace {

// glob() passes its errors to a function without a context.
thread_local std::vector<std::string> unreadable_folders;

int note_unreadable(const char* folder, int error) {
  if (error != ENOENT && error != ENOTDIR) {
    unreadable_folders.push_back(std::string(folder) + ": " + std::strerror(error));
  }
  return 0;
}

}  // namespace

bool has_wildcard(std::string_view pattern) {
  return pattern.find_first_of("*?[") != std::string_view::npos;
}

FileMatches match_files(const std::filesystem::path& pattern) {
  glob_t found{};
  FileMatches result;
  unreadable_folders.clear();
  if (glob(pattern.c_str(), 0, note_unreadable, &found) == 0) {
    result.files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  globfree(&found);
  result.unreadable = std::exchange(unreadable_folders, {});
  return result;
}

}  // namespace rayloc
