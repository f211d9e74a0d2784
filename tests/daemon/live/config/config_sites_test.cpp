// [[site]]: several sites in one configuration.
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/config/config.h"
#include "tests/support/test_paths.h"

namespace rayloc::config_sites_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kSite = test::data_path("/sites/meeting_room");

std::string site_table(const std::string& name, const std::string& more = "") {
  return "[[site]]\nname = \"" + name + "\"\ndirectory = \"" + kSite + "\"\n" + more;
}

std::string source_table(const std::string& site, int port, const std::string& ap = "ap1") {
  return "[[source]]\nsite = \"" + site + "\"\naccess_point = \"" + ap +
         "\"\nkind = \"udp\"\nlisten = \"127.0.0.1:" + std::to_string(port) + "\"\n";
}

class SitesOfAConfig : public ::testing::Test {
 protected:
  SitesOfAConfig()
      : file_(fs::path(::testing::TempDir()) / ("sites-" + std::to_string(getpid()) + ".toml")) {}
  void TearDown() override { fs::remove(file_); }

  Expected<DaemonSetup> load(const std::string& text) {
    std::ofstream(file_) << text;
    return load_daemon_setup(file_);
  }
  std::string errors(const std::string& text) {
    const Expected<DaemonSetup> setup = load(text);
    return setup ? "" : setup.error().message;
  }
  const fs::path file_;
};

TEST_F(SitesOfAConfig, EachHasItsSourcesMethodAndFolders) {
  const auto setup =
      load(site_table("office") + site_table("lab/2", "method = \"none\"\n") +
           site_table("hall", "record = false\n") + source_table("lab/2", 5501) +
           source_table("office", 5502, "ap1") + source_table("office", 5503, "ap2") +
           source_table("hall", 5504) + "[record]\ndirectory = \"/rec\"\n");
  ASSERT_TRUE(setup) << setup.error().message;
  ASSERT_EQ(setup->sites.size(), 3U);
  const SiteSetup& office = setup->sites[0];
  const SiteSetup& lab = setup->sites[1];
  EXPECT_EQ(office.site.name, "office");
  ASSERT_EQ(office.config.sources.size(), 2U);
  EXPECT_EQ(office.config.sources[1].access_point_index, 1U);
  EXPECT_EQ(office.config.sources[1].instance, "office-ap2");
  EXPECT_NE(office.config.engine.method, nullptr);
  EXPECT_EQ(office.config.record.directory, "/rec/office");
  EXPECT_EQ(lab.site.name, "lab/2");
  EXPECT_EQ(lab.folder, "lab%2F2");
  EXPECT_EQ(lab.config.record.directory, "/rec/lab%2F2");
  EXPECT_EQ(lab.config.engine.method, nullptr);
  ASSERT_EQ(lab.config.sources.size(), 1U);
  EXPECT_EQ(lab.config.sources[0].listen_port, 5501);
  EXPECT_EQ(lab.label(), "site 'lab/2': ");
  EXPECT_TRUE(setup->sites[2].config.record.directory.empty());
}

TEST_F(SitesOfAConfig, ASingleSiteKeepsTheEarlierFormat) {
  const auto setup = load("[site]\ndirectory = \"" + std::string(kSite) +
                          "\"\n[[source]]\naccess_point = \"ap1\"\nkind = \"udp\"\n"
                          "[record]\ndirectory = \"/rec\"\n");
  ASSERT_TRUE(setup) << setup.error().message;
  ASSERT_EQ(setup->sites.size(), 1U);
  EXPECT_EQ(setup->sites[0].config.record.directory, "/rec");
  EXPECT_EQ(setup->sites[0].config.sources[0].instance, "ap1");
  EXPECT_EQ(setup->sites[0].label(), "");
  EXPECT_EQ(setup->sites[0].folder, "");
}

TEST_F(SitesOfAConfig, ReportsErrorsWithTheirPosition) {
  const std::string file = file_.string();
  const std::string good = site_table("office") + site_table("lab");
  const std::string sources = source_table("office", 5501) + source_table("lab", 5502);
  EXPECT_EQ(errors(good + sources), "");
  EXPECT_THAT(errors(site_table("office") + site_table("office") + source_table("office", 5501)),
              HasSubstr(file + ":5:8: a second site called 'office' (the first: " +
                        file_.filename().string() + ":1)"));
  EXPECT_THAT(errors(good + source_table("office", 5501) + source_table("lab", 5501)),
              HasSubstr(file + ":16:10: a second source on UDP port 5501 (the first: "));
  EXPECT_THAT(errors(good + sources + source_table("lab", 5503)),
              HasSubstr(file + ":19:16: access point 'ap1' has a source already"));
  EXPECT_THAT(errors(good + source_table("office", 5501)),
              HasSubstr(file + ":4:1: [[site]] 'lab' has no [[source]]"));
  EXPECT_THAT(errors(good + sources + source_table("labb", 5503)),
              HasSubstr(file + ":18:8: no [[site]] is called 'labb'; did you mean 'lab'?"));
  EXPECT_THAT(errors(good + sources + "[[source]]\nkind = \"udp\"\naccess_point = \"ap2\"\n"),
              HasSubstr(file + ":17:1: [[source]] lacks 'site', and there are several"));
  EXPECT_THAT(errors("site = []\n" + sources), HasSubstr(file + ":1:8: 'site' lists none"));
  EXPECT_THAT(
      errors("[[site]]\nname = \"x\"\ndirectory = \"/nowhere\"\n" + source_table("x", 5501)),
      HasSubstr("/nowhere/site.toml"));
}

TEST_F(SitesOfAConfig, AReloadListsTheSitesThatDiffer) {
  const std::string two = site_table("office") + site_table("lab");
  const auto before = load(two + source_table("office", 5501) + source_table("lab", 5502)).value();
  const auto moved = load(two + source_table("lab", 5503) + source_table("office", 5501)).value();
  const ConfigChanges changes = before.values.changes_to(moved.values);
  EXPECT_THAT(changes.sites, ElementsAre("lab"));
  EXPECT_THAT(changes.applicable, ElementsAre("source lab-ap1.listen"));
  EXPECT_THAT(changes.needs_restart, IsEmpty());
  ConfigValues adopted = before.values;
  adopted.adopt_applicable(moved.values);
  EXPECT_THAT(adopted.changes_to(moved.values).sites, IsEmpty());
}

TEST_F(SitesOfAConfig, FilesOfOneThatAreWrongAreItsOwnTroubleInAReload) {
  const std::string text = site_table("office") + "[[site]]\ndirectory = \"/nowhere\"\n" +
                           source_table("office", 5501) + source_table("lab", 5502);
  std::ofstream(file_) << text;
  EXPECT_FALSE(load_daemon_setup(file_));
  const auto setup = reload_daemon_setup(file_, {{}, {{"/nowhere", "lab"}}});
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->sites[0].trouble, "");
  EXPECT_EQ(setup->sites[1].site.name, "lab");
  EXPECT_THAT(setup->sites[1].trouble, HasSubstr("/nowhere/site.toml"));
  EXPECT_FALSE(reload_daemon_setup(file_, {})) << "nobody knows what it is called";
}

TEST_F(SitesOfAConfig, TracksApplyToEachMethod) {
  const auto setup = load(site_table("office") + site_table("lab", "method = \"spotfi\"\n") +
                          source_table("office", 5501) + source_table("lab", 5502) +
                          "[engine]\ntracks = \"cloud\"\n");
  ASSERT_TRUE(setup) << setup.error().message;
  ASSERT_EQ(setup->sites.size(), 2U);
  for (const SiteSetup& site : setup->sites) {
    EXPECT_EQ(site.config.engine.tracks, "cloud") << site.site.name;
  }
}

// A site that is prepared anew must not take what the same reload refused: addresses that the
// others hash, for one.
TEST_F(SitesOfAConfig, AReloadKeepsValuesThatNeedARestart) {
  const std::string sites = site_table("office") + site_table("lab", "method = \"none\"\n") +
                            source_table("office", 5501) + source_table("lab", 5502);
  const auto before = load(sites +
                           "[engine]\nburst_s = 0.3\n[record]\ndirectory = \"/rec\"\n"
                           "rotate_mb = 1\n[curve]\nallow = [\"" +
                           std::string(40, 'a') + "\"]\n");
  ASSERT_TRUE(before) << before.error().message;
  std::ofstream(file_) << sites
                       << "[engine]\nburst_s = 1.0\nmethod = \"none\"\n[record]\n"
                          "directory = \"/elsewhere\"\nrotate_mb = 2\n"
                          "[privacy]\ntarget_id = \"hmac\"\n";
  const auto now = reload_daemon_setup(file_, {before->config, {}});
  ASSERT_TRUE(now) << now.error().message;
  const DaemonConfig& office = now->sites[0].config;
  EXPECT_EQ(office.engine.burst, std::chrono::milliseconds(300));
  EXPECT_EQ(office.engine.method, before->config.engine.method);
  EXPECT_EQ(office.record.directory, "/rec/office");
  EXPECT_EQ(office.privacy.target_id, TargetId::kMac);
  EXPECT_EQ(office.record.rotate_bytes, std::uint64_t{2} << 20U) << "a reload applies it";
  EXPECT_TRUE(now->config.curve.allow.empty()) << "it is no longer stated";
  EXPECT_EQ(now->sites[1].config.engine.method, nullptr) << "the site's own";
  EXPECT_THAT(
      before->values.changes_to(now->values).needs_restart,
      ElementsAre("engine.burst_s", "engine.method", "privacy.target_id", "record.directory"));
}

}  // namespace
}  // namespace rayloc::config_sites_test
