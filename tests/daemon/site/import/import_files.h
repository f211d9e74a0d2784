// Files of other programs in a folder of the test, and what becomes of them.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/import_scene.h"

namespace rayloc::test {

class ImportFiles : public ::testing::Test {
 protected:
  using path = std::filesystem::path;

  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("rayloc-import-test." + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  path file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  static Expected<ImportedScene> import(const path& file, const ImportOptions& options = {}) {
    return import_scene(file, *MaterialTable::parse(kDefaultMaterialTable, "materials"), options);
  }
  std::string refusal(const std::string& name, const std::string& content) const {
    const auto imported = import(file(name, content));
    return imported ? "" : imported.error().message.substr(folder_.string().size() + 1);
  }
  static std::string remarks(const ImportedScene& imported) {
    return fmt::format("{}", fmt::join(imported.remarks, "\n"));
  }

  path folder_;
};

}  // namespace rayloc::test
