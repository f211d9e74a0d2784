// The import of an uploaded file by another process, for which scripts are used here.
#include "daemon/live/studio/import_process.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::import_process_test {
namespace {

namespace fs = std::filesystem;

class ImportProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("rayloc-import-process." + std::to_string(getpid()));
    fs::create_directories(folder_);
    std::ofstream(folder_ / "import.ifc") << "the content";
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Arguments of the script: scene import FILE --out FOLDER --unit=mm --name=NAME.
  Expected<ImportedFiles> run(const std::string& script,
                              std::chrono::seconds limit = std::chrono::seconds(60),
                              const std::function<bool()>& is_stopping = never) const {
    const fs::path program = folder_ / "program";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(program, fs::perms::owner_all);
    auto result = run_import(
        program, folder_ / "import.ifc", {"--unit=mm", "--name=my room"}, limit, is_stopping);
    fs::remove(program);
    return result;
  }
  static bool never() { return false; }
  bool leaves_nothing() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()) == 1;
  }

  fs::path folder_;
};

TEST_F(ImportProcess, ReturnsTheFilesAndTheRemarks) {
  const auto imported =
      run("[ \"$1 $2 $4 $6 $7\" = \"scene import --out --unit=mm --name=my room\" ] || exit 1\n"
          "mkdir \"$5/meshes\"; cp \"$3\" \"$5/scene.xml\"; echo mesh > \"$5/meshes/a.ply\"\n"
          "echo \"$5: 1 object\" >&2; echo '  IFC' >&2; echo '  a second remark' >&2");
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(imported->files.size(), 2U);
  EXPECT_EQ(imported->files.at("scene.xml"), "the content");
  EXPECT_EQ(imported->files.at("meshes/a.ply"), "mesh\n");
  EXPECT_EQ(imported->remarks, (std::vector<std::string>{"IFC", "a second remark"}));
  EXPECT_TRUE(leaves_nothing());
}

TEST(StatedOptions, AreThoseOnTheContentOfTheFile) {
  EXPECT_EQ(stated_options({{"name", "plan.dxf"},
                            {"out", "/etc"},
                            {"materials", "/etc/passwd"},
                            {"force", "1"},
                            {"--out", "/etc"},
                            {"unit", "mm"},
                            {"scale", ""},
                            {"walls", "A WALL --out"},
                            {"walls", "0"}}),
            (std::vector<std::string>{"--unit=mm", "--walls=A WALL --out", "--walls=0"}));
}

TEST_F(ImportProcess, ASignalThatEndsTheReaderIsAnError) {
  const auto imported = run("kill -SEGV $$");
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().kind, ErrorKind::kBadInput);
  EXPECT_NE(imported.error().message.find("import.ifc: "), std::string::npos);
  EXPECT_NE(imported.error().message.find("signal 11"), std::string::npos)
      << imported.error().message;
  EXPECT_TRUE(leaves_nothing());
}

TEST_F(ImportProcess, AReaderWithoutAnEndIsEnded) {
  const auto imported = run("exec sleep 1000", std::chrono::seconds(1));
  ASSERT_FALSE(imported);
  EXPECT_NE(imported.error().message.find("longer than 1 s"), std::string::npos)
      << imported.error().message;
  EXPECT_TRUE(leaves_nothing());
}

TEST_F(ImportProcess, ReturnsTheMessageOfARefusal) {
  const auto imported = run("echo 'import.ifc:3: is wrong' >&2; exit 65");
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().message, "import.ifc:3: is wrong");
  EXPECT_TRUE(leaves_nothing());
}

TEST_F(ImportProcess, AMissingProgramIsReported) {
  const auto imported =
      run_import("/nowhere/rayloc", folder_ / "import.ifc", {}, std::chrono::seconds(60), never);
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().kind, ErrorKind::kUnavailable);
}

TEST_F(ImportProcess, AStopEndsTheReader) {
  const auto begin = std::chrono::steady_clock::now();
  int calls = 0;
  const auto imported =
      run("exec sleep 1000", std::chrono::seconds(60), [&] { return ++calls > 2; });
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().kind, ErrorKind::kUnavailable);
  EXPECT_NE(imported.error().message.find("ended with the studio"), std::string::npos)
      << imported.error().message;
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
  EXPECT_TRUE(leaves_nothing());
}

// A link to nothing, or to itself, is no file of the result.
TEST_F(ImportProcess, OnlyFilesAreReturned) {
  const auto imported =
      run("ln -s /nowhere \"$5/link\"; ln -s loop \"$5/loop\"; echo x > \"$5/a\"");
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(imported->files.size(), 1U);
  EXPECT_TRUE(leaves_nothing());
}

TEST_F(ImportProcess, AMissingFolderIsReported) {
  const auto imported =
      run_import("/bin/true", folder_ / "missing" / "a.ifc", {}, std::chrono::seconds(60), never);
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().kind, ErrorKind::kUnavailable);
  EXPECT_NE(imported.error().message.find("No such file"), std::string::npos)
      << imported.error().message;
}

}  // namespace
}  // namespace rayloc::import_process_test
