#include "daemon/base/output_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::output_file_test {
namespace {

using ::testing::HasSubstr;

TEST(OutputFile, WritesAllBytesAndReplacesAFile) {
  const std::string path = ::testing::TempDir() + "/output-" + std::to_string(::getpid());
  std::ofstream(path) << "a longer text from before";
  auto file = OutputFile::open(path);
  ASSERT_TRUE(file) << file.error().message;
  file->write("one\n");
  file->write(std::string_view("\0\r\n", 3));
  ASSERT_TRUE(file->close());
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(text, std::string("one\n\0\r\n", 7));
  std::filesystem::remove(path);
}

TEST(OutputFile, ReportsAPathThatCannotBeOpened) {
  const auto file = OutputFile::open("/nonexistent/file");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(file.error().message, HasSubstr("/nonexistent/file"));
}

// The bytes may reach the disk only when the file is closed.
TEST(OutputFile, ReportsAFullDiskWhenItIsClosed) {
  auto file = OutputFile::open("/dev/full");
  ASSERT_TRUE(file) << file.error().message;
  file->write("text");
  const auto closed = file->close();
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(closed.error().message, HasSubstr("/dev/full"));
}

// The write that fails may be followed by others that fit.
TEST(OutputFile, RemembersAFailedWrite) {
  auto file = OutputFile::open("/dev/full");
  ASSERT_TRUE(file) << file.error().message;
  file->write(std::string(1U << 20U, 'x'));
  file->write("");
  EXPECT_FALSE(file->close());
}

}  // namespace
}  // namespace rayloc::output_file_test
