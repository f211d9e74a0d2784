// PathGridFiles: path grids in a cache folder, one file each, named by its key.
//
//   offset  bytes  content
//        0      8  "RLPATHGR"
//        8      8  length of the content, little-endian
//       16      8  FNV-1a of the content, little-endian
//       24      -  content (path_grid.h)
//
// A file is written beside its final path and renamed, so that no other program reads a partial
// one. A truncated, damaged or foreign file is ignored, logged and replaced. The folder is bounded:
// the grids used longest ago are removed first. A failure of a cache is never a failure of the
// program.
//
// Thread safety: several programs may use one folder; an object is for one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "engine/localize/path_grid.h"

namespace rayloc {

class PathGridFiles : public PathGridStore {
 public:
  struct Options {
    std::filesystem::path directory;                    // created at the first write
    std::uint64_t most_bytes = std::uint64_t{1} << 30;  // limit for all grids together
    std::function<void(const std::string& line)> log;   // receives messages for people
  };
  explicit PathGridFiles(Options options) : options_(std::move(options)) {}

  std::optional<std::string> load(const std::string& key) override;
  void save(const std::string& key, std::string_view bytes) override;
  void refuse(const std::string& key) override;

 private:
  std::filesystem::path file_of(const std::string& key) const;
  bool write(const std::filesystem::path& file, std::string_view bytes) const;
  void drop_oldest(const std::filesystem::path& kept) const;
  void report(const std::filesystem::path& file, const std::string& what) const;

  Options options_;
};

// The folder for caches: $CACHE_DIRECTORY, which systemd sets for a service, otherwise rayloc/ in
// $XDG_CACHE_HOME, otherwise in ~/.cache. Empty if none of them is set.
std::optional<std::filesystem::path> cache_directory();

}  // namespace rayloc
