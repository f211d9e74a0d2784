// `rayloc check-config` and `rayloc config` as a script sees them: output and exit status.
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::check_config_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Outcome {
  int status = -1;
  std::string output;  // stdout and stderr
};

Outcome rayloc(const std::string& arguments) {
  const std::string command = rayloc::test::program_path("rayloc") + " " + arguments + " 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    outcome.output.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

const fs::path kSite = fs::path(rayloc::test::data_path()) / "sites" / "meeting_room";

// A folder of its own for each test: they run side by side.
class CheckConfig : public ::testing::Test {
 protected:
  CheckConfig()
      : folder_(fs::path(::testing::TempDir()) /
                (std::string("check_config-") +
                 ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string config(const std::string& site, const std::string& rest) const {
    return write("raylocd.toml", "[site]\ndirectory = \"" + site + "\"\n" + rest);
  }

  fs::path folder_;
};

constexpr const char* kSource = "[[source]]\nkind = \"udp\"\naccess_point = \"ap1\"\n";

TEST_F(CheckConfig, GoodOneExitsWithZero) {
  // Where nothing is to be located nothing is lacking.
  const std::string file =
      config(kSite.string(), kSource + std::string("[engine]\nmethod = \"none\"\n"));
  const Outcome outcome = rayloc("check-config " + file);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.output,
            file + ": good: site 'meeting_room', 3 access points, not calibrated, 1 source\n");
  EXPECT_EQ(rayloc("check-config --quiet " + file).output, "");
}

TEST(Field, CheckConfigReportsASiteThatCannotLocate) {
  const Outcome outcome = rayloc("check-config " + kSite.string());
  EXPECT_EQ(outcome.status, 0) << "raylocd starts with it";
  EXPECT_THAT(outcome.output,
              HasSubstr("site.toml: nothing can be located: the site is not calibrated; see "
                        "`rayloc calibrate --help`"));
  EXPECT_THAT(outcome.output, HasSubstr("site.toml: people are not looked for"));
}

TEST_F(CheckConfig, SiteAloneIsCheckedAsWell) {
  EXPECT_EQ(rayloc("check-config " + kSite.string()).status, 0);
  EXPECT_EQ(rayloc("check-config " + (kSite / "site.toml").string()).status, 0);
}

TEST_F(CheckConfig, EveryErrorIsALineAndTheStatusIs78) {
  const std::string file =
      config(kSite.string(), std::string(kSource) + "listen = \"x\"\n[log]\nlevl = \"info\"\n");
  const Outcome outcome = rayloc("check-config --quiet " + file);
  EXPECT_EQ(outcome.status, 78);
  EXPECT_THAT(outcome.output, StartsWith(file + ":6:10: 'listen' is no ADDRESS:PORT"));
  EXPECT_THAT(outcome.output,
              HasSubstr("\n" + file +
                        ":8:1: unknown key 'levl' in [log]; did "
                        "you mean 'level'?\n"));
}

TEST_F(CheckConfig, SecretsAreReadAsRaylocdReadsThem) {
  const std::string any_address = std::string(kSource) + "[http]\nlisten = \"0.0.0.0:8480\"\n";
  const std::string token = (folder_ / "http.token").string();
  const Outcome missing = rayloc(
      "check-config " + config(kSite.string(), any_address + "token_file = \"" + token + "\"\n"));
  EXPECT_EQ(missing.status, 78);
  EXPECT_THAT(missing.output, HasSubstr(token + ": the token cannot be read: No such file"));

  // The service's own view, once the token is there.
  fs::permissions(write("http.token", "0123456789abcdef\n"), fs::perms(0600));
  ASSERT_EQ(setenv("CREDENTIALS_DIRECTORY", folder_.c_str(), 1), 0);
  const Outcome passed = rayloc("check-config " + config(kSite.string(), any_address));
  EXPECT_EQ(passed.status, 0) << passed.output;
  ASSERT_EQ(unsetenv("CREDENTIALS_DIRECTORY"), 0);
  EXPECT_THAT(rayloc("check-config " + config(kSite.string(), any_address)).output,
              HasSubstr("set token_file"));
}

TEST_F(CheckConfig, RootGetsAWarningOfFilesItsServiceCannotRead) {
  const std::string key = write("privacy.key", std::string(32, 'k') + "\n");
  fs::permissions(key, fs::perms::owner_read | fs::perms::owner_write);
  const Outcome outcome =
      rayloc("check-config --quiet " +
             config(kSite.string(),
                    std::string(kSource) + "[privacy]\ntarget_id = \"hmac\"\nkey_file = \"" + key +
                        "\"\n"));
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  const bool root = geteuid() == 0;
  EXPECT_EQ(
      outcome.output.find("and let systemd pass the credential privacy.key") != std::string::npos,
      root)
      << outcome.output;
}

TEST_F(CheckConfig, SceneIsReadAsRaylocdReadsIt) {
  fs::copy(kSite / "site.toml", folder_ / "site.toml");
  const std::string scene = write("scene.xml", "<scene version=\"2.1.0\"><shape></scene>");
  const Outcome outcome = rayloc("check-config " + config(folder_.string(), kSource));
  EXPECT_EQ(outcome.status, 78);
  EXPECT_THAT(outcome.output, HasSubstr(scene));
}

TEST_F(CheckConfig, FileThatIsNotThereIsAConfigurationError) {
  const Outcome outcome = rayloc("check-config " + (folder_ / "none.toml").string());
  EXPECT_EQ(outcome.status, 78);
  EXPECT_THAT(outcome.output, HasSubstr("none.toml: cannot be opened"));
}

TEST_F(CheckConfig, WithoutAFileIsUsage) { EXPECT_EQ(rayloc("check-config").status, 64); }

TEST_F(CheckConfig, DefaultConfigurationIsAFileToStartFrom) {
  const Outcome example = rayloc("config default");
  EXPECT_EQ(example.status, 0);
  std::string text = example.output;
  const std::string directory = "/etc/raylocd/site";
  text.replace(text.find(directory), directory.size(), kSite.string());
  text.replace(text.find("#access_point"), 1, "");
  EXPECT_EQ(rayloc("check-config " + write("raylocd.toml", text)).status, 0);
  const Outcome shown = rayloc("config show " + (folder_ / "raylocd.toml").string());
  EXPECT_EQ(shown.status, 0);
  EXPECT_THAT(shown.output, HasSubstr("access_point = \"ap1\"\n"));
  EXPECT_THAT(shown.output, HasSubstr("ring_frames = 8192  # default\n"));
}

TEST_F(CheckConfig, ConfigNeedsASubcommand) {
  EXPECT_EQ(rayloc("config").status, 64);
  EXPECT_THAT(rayloc("config schema").output, StartsWith("{\n  \"$schema\""));
}

}  // namespace
}  // namespace rayloc::check_config_test
