#include "tests/e2e/unit_filters.h"

#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "tests/e2e/process.h"
#include "tests/support/test_paths.h"

namespace rayloc::e2e {
namespace {

std::string unit_file(const std::string& name) {
  return test::source_path("/deploy/units/") + name;
}

}  // namespace

std::string unit_text(const std::string& name) { return read_text(unit_file(name)); }

std::set<std::string> allowed_calls(const std::string& unit) {
  std::set<std::string> allowed;
  FILE* const pipe =
      popen((test::source_path("/tests/e2e/allowed_calls ") + unit_file(unit)).c_str(), "r");
  std::array<char, 256> line{};
  while (fgets(line.data(), line.size(), pipe) != nullptr) {
    allowed.emplace(line.data(), std::strcspn(line.data(), "\n"));
  }
  if (pclose(pipe) != 0 || allowed.empty()) {
    throw std::runtime_error("no system calls are known of " + unit);
  }
  return allowed;
}

std::vector<std::string> filters([[maybe_unused]] const std::filesystem::path& folder,
                                 [[maybe_unused]] const std::set<std::string>& calls,
                                 [[maybe_unused]] const std::string& families) {
#ifdef RAYLOC_HAS_SECCOMP_LAUNCHER
  const std::filesystem::path list = folder / "calls";
  std::ofstream file(list);
  for (const std::string& call : calls) {
    file << call << '\n';
  }
  return {test::program_path("seccomp_launcher"), list.string(), families};
#else
  return {};
#endif
}

bool has_filters() {
#ifdef RAYLOC_HAS_SECCOMP_LAUNCHER
  return true;
#else
  return false;
#endif
}

}  // namespace rayloc::e2e
