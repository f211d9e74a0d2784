#include "daemon/live/cluster/operate/scratch_folder.h"

#include <cstdlib>
#include <system_error>
#include <utility>

namespace rayloc {
namespace {

void remove_folder(const std::filesystem::path& path) {
  std::error_code failed;
  std::filesystem::remove_all(path, failed);
}

}  // namespace

ScratchFolder::ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {
  remove_folder(path_);
}

ScratchFolder::~ScratchFolder() { remove_folder(path_); }

Expected<std::filesystem::path> make_temporary_folder(const std::string& prefix) {
  std::string name = (std::filesystem::temp_directory_path() / (prefix + "-XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) {
    return make_error(ErrorKind::kUnavailable, name + ": no folder can be made there");
  }
  return std::filesystem::path(name);
}

}  // namespace rayloc
