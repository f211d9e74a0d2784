// Tests the parts that all kinds of keys share; tests/daemon/live/publish/curve_test.cpp has those
// of a CURVE key.
#include "daemon/base/secret_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::secret_file_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr KeyKind kToken{"token", "make one with keygen"};

class SecretFile : public ::testing::Test {
 protected:
  SecretFile()
      : file_(fs::path(::testing::TempDir()) /
              ("secret-" + std::to_string(::getpid()) +
               ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove(file_);
  }
  void TearDown() override { fs::remove(file_); }
  void write(const std::string& text, unsigned permissions) const {
    std::ofstream(file_) << text;
    fs::permissions(file_, fs::perms(permissions));
  }
  const fs::path file_;
};

TEST_F(SecretFile, IsTheFirstLineWithoutBlanksAtItsEnd) {
  write("a b \r\nsecond\n", 0600);
  EXPECT_EQ(read_secret(file_, kToken), "a b");
  write("", 0600);
  EXPECT_EQ(read_secret(file_, kToken), "");
}

TEST_F(SecretFile, IsRefusedIfEveryUserMayUseIt) {
  for (const unsigned permissions : {0604U, 0602U, 0601U}) {
    write("secret\n", permissions);
    const auto read = read_secret(file_, kToken);
    ASSERT_FALSE(read) << permissions;
    EXPECT_EQ(read.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(read.error().message, HasSubstr("token"));
  }
  write("secret\n", 0640);
  EXPECT_EQ(read_secret(file_, kToken), "secret") << "systemd passes credentials to the group";
}

TEST_F(SecretFile, ReportsAMissingFileWithItsAdvice) {
  const auto read = read_secret(file_, kToken);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(read.error().message, HasSubstr(file_.string()));
  EXPECT_THAT(read.error().message, HasSubstr(kToken.advice));
}

TEST_F(SecretFile, IsWrittenForItsOwnerAloneAndNeverReplaced) {
  ASSERT_TRUE(write_secret(file_, "first"));
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  const auto again = write_secret(file_, "second");
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, ErrorKind::kUnavailable);
  EXPECT_EQ(read_secret(file_, kToken), "first");
}

}  // namespace
}  // namespace rayloc::secret_file_test
