// ScratchFolder: a folder that is removed, with its content, at the end of its scope.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"

namespace rayloc {

class ScratchFolder {
 public:
  // Removes what an earlier process has left at that path; creates nothing there.
  explicit ScratchFolder(std::filesystem::path path);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// Creates a folder for temporary files, named PREFIX-XXXXXX: no other process can have its name.
// The caller removes it. kUnavailable: it cannot be created.
Expected<std::filesystem::path> make_temporary_folder(const std::string& prefix);

}  // namespace rayloc
