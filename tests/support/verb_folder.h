// VerbFolder: a folder of a test in which `rayloc` runs.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/rayloc_process.h"

namespace rayloc::test {

class VerbFolder : public ::testing::Test {
 public:
  ~VerbFolder() override { std::filesystem::remove_all(folder_); }

 protected:
  explicit VerbFolder(const std::string& name)
      : folder_(std::filesystem::path(::testing::TempDir()) / name) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }

  static std::string test_name() {
    return ::testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  std::string read(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // Standard output of a run that must succeed.
  static std::string run(const std::vector<std::string>& arguments) {
    const auto finished = RaylocProcess(arguments).wait();
    EXPECT_EQ(finished.status, 0) << finished.err;
    return finished.out;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace rayloc::test
