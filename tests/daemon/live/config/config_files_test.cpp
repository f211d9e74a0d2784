// Configurations of several files, what changes between two of them, and the manual page.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/config/config_reader.h"
#include "daemon/live/config/config_schema.h"

namespace rayloc::config_files_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ConfigFiles : public ::testing::Test {
 public:
  ~ConfigFiles() override { fs::remove_all(folder_); }

 protected:
  ConfigFiles() {
    std::string name = (fs::temp_directory_path() / "config_files.XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    fs::create_directory(folder_ / "conf.d");
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  // The error of loading the file, without the folder in its paths.
  std::string errors(const fs::path& file) const {
    const Expected<DaemonConfig> config = load_config(file);
    return config
               ? ""
               : std::regex_replace(config.error().message, std::regex(folder_.string() + "/"), "");
  }

  fs::path folder_;
};

constexpr const char* kMain =
    "include = [\"conf.d/*.toml\"]\n[site]\ndirectory = \"/s\"\n[publish]\nheartbeat_s = 2\n";

TEST_F(ConfigFiles, IncludedFilesAddKeysAndSources) {
  const fs::path main = write("raylocd.toml", kMain);
  write("conf.d/10-one.toml",
        "[[source]]\naccess_point = \"a\"\nkind = \"pcap\"\nfile = \"one.pcap\"\n");
  write("conf.d/20-two.toml",
        "[[source]]\naccess_point = \"b\"\nkind = \"udp\"\n"
        "[publish]\nsend_high_water_mark = 50\n[log]\nlevel = \"debug\"\n");
  const Expected<DaemonConfig> config = load_config(main);
  ASSERT_TRUE(config) << config.error().message;
  ASSERT_EQ(config->sources.size(), 2U);
  EXPECT_EQ(config->sources[0].access_point, "a");
  EXPECT_EQ(config->sources[0].files, (std::vector<fs::path>{folder_ / "conf.d/one.pcap"}))
      << "from the folder of its file";
  EXPECT_EQ(config->sources[1].place, (folder_ / "conf.d/20-two.toml").string() + ":1:1: ");
  EXPECT_EQ(config->publish.send_high_water_mark, 50U);
  EXPECT_EQ(config->publish.heartbeat, std::chrono::seconds(2));
  EXPECT_EQ(config->log.level, LogLevel::kDebug);
}

TEST_F(ConfigFiles, ErrorsNameTheFileThatTheyAreIn) {
  const fs::path main = write("raylocd.toml", kMain);
  write("conf.d/10-one.toml",
        "[[source]]\nkind = \"udp\"\nlissen = \":5501\"\n[publish]\nheartbeat_s = 3\n");
  write("conf.d/20-two.toml", "include = \"x.toml\"\n[engine]\nburst_s = 99\n");
  write("conf.d/30-three.toml", "[log\n");
  EXPECT_EQ(errors(main),
            "conf.d/10-one.toml:3:1: unknown key 'lissen' in [[source]]; did you mean 'listen'?\n"
            "conf.d/10-one.toml:5:15: 'heartbeat_s' is stated already at raylocd.toml:5:15; leave "
            "one of them\n"
            "conf.d/20-two.toml:1:11: an included file includes no others; add them to 'include' "
            "of raylocd.toml:1\n"
            "conf.d/20-two.toml:3:11: 'burst_s' is 99; it must be from 0.01 to 10 s\n"
            "conf.d/30-three.toml:1:5: not TOML: parsing table header: expected ']', saw '\\n'");
}

TEST_F(ConfigFiles, ANamedFileMustExistAPatternNeedNot) {
  const std::string rest = "\n[site]\ndirectory = \"/s\"\n[[source]]\nkind = \"udp\"\n";
  EXPECT_EQ(errors(write("a.toml", "include = \"nothing-*.toml\"" + rest)), "");
  EXPECT_EQ(
      errors(write("b.toml", "include = \"nothing.toml\"" + rest)),
      "b.toml:1:11: 'nothing.toml' is not there; paths are taken from the folder of this file");
  EXPECT_EQ(errors(write("c.toml", "include = [\"c.toml\"]" + rest)),
            "c.toml:1:11: 'c.toml' names this very file");
  EXPECT_THAT(errors(write("d.toml", "include = 5" + rest)),
              HasSubstr("d.toml:1:11: 'include' is"));
}

// Links that go round: what even root cannot read.
TEST_F(ConfigFiles, ReportsUnreadableIncludesAsErrors) {
  const std::string rest = "\n[site]\ndirectory = \"/s\"\n[[source]]\nkind = \"udp\"\n";
  fs::create_symlink("round", folder_ / "round");
  EXPECT_EQ(errors(write("a.toml", "include = \"round/*.toml\"" + rest)),
            "a.toml:1:11: 'round/*.toml': cannot list round: Too many levels of symbolic links");
  EXPECT_EQ(errors(write("b.toml", "include = \"round/b.toml\"" + rest)),
            "b.toml:1:11: 'round/b.toml' cannot be read: Too many levels of symbolic links");
}

TEST_F(ConfigFiles, SortsChangesIntoReloadAndRestart) {
  const std::string source = "[[source]]\naccess_point = \"a\"\nkind = \"udp\"\n";
  const std::string site = "[site]\ndirectory = \"/s\"\n";
  const auto values = [&](const std::string& text) {
    const auto document = TomlDocument::parse(text, "raylocd.toml");
    EXPECT_TRUE(document) << document.error().message;
    return ConfigValues::of(read_config(**document));
  };
  const ConfigValues first = values(site + source);
  EXPECT_THAT(first.changes_to(first).applicable, IsEmpty());
  EXPECT_THAT(first.changes_to(first).needs_restart, IsEmpty());
  // A default that is stated is no change.
  EXPECT_THAT(first.changes_to(values(site + source + "[log]\nlevel = \"info\"\n")).applicable,
              IsEmpty());
  const ConfigChanges changes =
      first.changes_to(values(site + source + "listen = \":5501\"\n[log]\nlevel = \"debug\"\n" +
                              "[publish]\nheartbeat_s = 5\nendpoint = \"tcp://127.0.0.1:7000\"\n"));
  EXPECT_THAT(changes.applicable, ElementsAre("log.level", "publish.heartbeat_s"));
  EXPECT_THAT(changes.needs_restart, ElementsAre("publish.endpoint", "source 1.listen"));
  const ConfigChanges more = first.changes_to(values(
      site + source + "[[source]]\naccess_point = \"b\"\nkind = \"udp\"\nlisten = \":1\"\n"));
  EXPECT_THAT(more.needs_restart,
              ElementsAre("source",
                          "source 2.access_point",
                          "source 2.kind",
                          "source 2.listen",
                          "source 2.stall_after_s"));
}

TEST(ConfigManual, DescribesEveryKeyAndIsSoundRoff) {
  const std::string page = config_manual_page();
  for (const ConfigOption& option : config_options()) {
    EXPECT_THAT(page, HasSubstr("\n.B " + std::string(option.key) + "\n")) << option.key;
  }
  const fs::path file = fs::path(::testing::TempDir()) / "raylocd.toml.5";
  std::ofstream(file) << page;
  if (std::system("command -v groff >/dev/null") != 0) {
    GTEST_SKIP() << "no groff here";
  }
  const fs::path messages = file.string() + ".said";
  ASSERT_EQ(
      std::system(("groff -man -Tascii -ww " + file.string() + " >/dev/null 2>" + messages.string())
                      .c_str()),
      0);
  EXPECT_EQ(fs::file_size(messages), 0U) << "groff warns: " << messages;
}

}  // namespace
}  // namespace rayloc::config_files_test
