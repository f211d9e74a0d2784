#include "tests/support/test_paths.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace rayloc::test {
namespace {

namespace fs = std::filesystem;

struct BuildTree {
  fs::path build;
  std::string source;
};

BuildTree find_build_tree() {
  const fs::path program = fs::read_symlink("/proc/self/exe");
  for (fs::path folder = program.parent_path(); folder != folder.root_path();
       folder = folder.parent_path()) {
    std::ifstream cache(folder / "CMakeCache.txt");
    constexpr std::string_view kEntry = "rayloc_SOURCE_DIR:STATIC=";
    for (std::string line; std::getline(cache, line);) {
      if (line.starts_with(kEntry)) {
        return {folder, line.substr(kEntry.size())};
      }
    }
  }
  throw std::runtime_error(program.string() + ": no CMakeCache.txt of RayLoc in a folder above");
}

const BuildTree& build_tree() {
  static const BuildTree tree = find_build_tree();
  return tree;
}

}  // namespace

std::string source_path(std::string_view path) { return build_tree().source + std::string(path); }

std::string data_path(std::string_view path) {
  const char* const stated = std::getenv("RAYLOC_TEST_DATA");
  return (stated != nullptr ? stated : source_path("/tests/data")) + std::string(path);
}

std::string program_path(std::string_view name) {
  const char* const stated = std::getenv("RAYLOC_BIN");
  return (stated != nullptr ? fs::path(stated) : build_tree().build / "bin") / name;
}

}  // namespace rayloc::test
