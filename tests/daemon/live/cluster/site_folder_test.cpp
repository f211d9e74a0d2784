// Tests the folder of applied sites: its differences from the bundles on the broker, and their
// settlement.
#include "daemon/live/cluster/operate/site_folder.h"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/cluster/fake_broker.h"

namespace rayloc::site_folder_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Kind = SiteChange::Kind;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

class SiteFolderTest : public ::testing::Test {
 protected:
  SiteFolderTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Stores a bundle for the site; returns its hash.
  std::string store(const std::string& site, const std::string& text) {
    SiteBundle bundle;
    bundle.files["site.toml"] = text;
    EXPECT_TRUE(store_bundle(broker_, site, bundle, 1));
    return bundle.hash();
  }
  // Settles the only difference from these bundles; nothing where there is none.
  std::optional<SiteChange> settle(const std::map<std::string, std::string>& stored) {
    const std::vector<SiteDifference> differences = sites_.differences(stored);
    EXPECT_LE(differences.size(), 1U);
    return differences.empty() ? std::nullopt
                               : std::optional(sites_.settle(broker_, differences.front()));
  }

  const fs::path folder_ = fs::temp_directory_path() / ("site_folder." + std::to_string(getpid()));
  FakeBroker broker_;
  ErrorKind refusal_ = ErrorKind::kConfiguration;
  SiteFolder sites_{folder_, [this](const fs::path& site) -> Expected<std::string> {
                      const std::string text = text_of(site / "site.toml");
                      return text == "bad" ? make_error(refusal_, "it is bad")
                                           : Expected<std::string>(text);
                    }};
};

TEST_F(SiteFolderTest, TakesASiteOnceAndRemovesItAgain) {
  const std::string hash = store("the hall", "good");
  const auto taken = settle({{"the hall", hash}});
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->kind, Kind::kReplaced) << taken->reason;
  EXPECT_TRUE(taken->has_changed());
  EXPECT_EQ(text_of(folder_ / "the%20hall" / "site.toml"), "good");
  EXPECT_THAT(text_of(folder_ / "the%20hall.toml"), HasSubstr("name = \"the hall\""));
  EXPECT_FALSE(fs::exists(folder_ / "the%20hall.new"));
  EXPECT_FALSE(settle({{"the hall", hash}}));

  const auto removed = settle({{"the hall", ""}});
  ASSERT_TRUE(removed);
  EXPECT_EQ(removed->kind, Kind::kRemoved);
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_FALSE(settle({{"the hall", ""}}));
}

TEST_F(SiteFolderTest, ARefusedSiteIsTriedOnceAndAnUnavailableOneAgain) {
  const std::string hash = store("hall", "bad");
  refusal_ = ErrorKind::kUnavailable;
  for (int i = 0; i < 2; ++i) {
    const auto refused = settle({{"hall", hash}});
    ASSERT_TRUE(refused) << i;
    EXPECT_EQ(refused->kind, Kind::kRefused);
    EXPECT_FALSE(refused->has_changed());
  }
  refusal_ = ErrorKind::kConfiguration;
  const auto refused = settle({{"hall", hash}});
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->reason, "it is bad");
  EXPECT_FALSE(settle({{"hall", hash}}));
  EXPECT_TRUE(fs::is_empty(folder_));
}

// The messages of its stream have changed since it was stored.
class ChangedBundle : public SiteFolderTest {
 protected:
  ChangedBundle() {
    // The pieces of a replaced bundle are removed.
    broker_.answer = [](const std::string& /*subject*/) { return std::string("{}"); };
  }
  // The message that replaces the last one of that subject; nothing: it is removed.
  void replace(const std::string& subject, const std::optional<std::string>& data) {
    const std::string stream(kBundleStream);
    const auto last = broker_.last_of(stream, subject);
    ASSERT_TRUE(last && *last) << subject;
    if (!data) {
      broker_.drop(stream, (*last)->sequence);
    } else {
      const auto sent = broker_.publish_behind(subject, *data, (*last)->sequence);
      ASSERT_TRUE(sent && sent->is_last) << subject;
    }
  }
  static std::string subject_of(const std::string& last) { return "rayloc.v1.bundle.hall." + last; }
  // The next version of the site is refused for `reason`, and the present one stays.
  void expect_refused(const std::string& hash, const std::string& reason) {
    const auto refused = settle({{"hall", hash}});
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->kind, Kind::kRefused);
    EXPECT_FALSE(refused->has_changed());
    EXPECT_THAT(refused->reason, HasSubstr(reason));
    EXPECT_EQ(text_of(folder_ / "hall" / "site.toml"), "first");
    EXPECT_FALSE(fs::exists(folder_ / "hall.new"));
  }
  void take_first() {
    const auto taken = settle({{"hall", store("hall", "first")}});
    ASSERT_TRUE(taken);
    ASSERT_EQ(taken->kind, Kind::kReplaced) << taken->reason;
  }
};

TEST_F(ChangedBundle, WithOtherBytesIsRefused) {
  take_first();
  const std::string hash = store("hall", "second");
  replace(subject_of(hash + ".0"), "forged");
  expect_refused(hash, "changed bytes");
}

TEST_F(ChangedBundle, ThatIsShorterIsRefused) {
  take_first();
  const std::string hash = store("hall", "second");
  replace(subject_of(hash + ".0"), "sec");
  expect_refused(hash, "shorter");
}

TEST_F(ChangedBundle, WithoutOneOfItsPiecesIsRefused) {
  take_first();
  const std::string hash = store("hall", "second");
  replace(subject_of(hash + ".0"), std::nullopt);
  expect_refused(hash, "missing");
}

TEST_F(ChangedBundle, WithAnInvalidEntryIsRefused) {
  take_first();
  const std::string hash = store("hall", "second");
  for (const std::string entry : {"", "{}", R"({"hash": 1, "pieces": 1, "files": []})"}) {
    replace(subject_of("_current"), entry);
    expect_refused(hash, "apply");
    sites_ = SiteFolder(folder_, [](const fs::path& /*site*/) -> Expected<std::string> {
      return std::string("good");
    });  // it has not refused that hash yet
  }
}

TEST_F(SiteFolderTest, RefusesANameThatAConfigurationCannotHold) {
  EXPECT_TRUE(is_plain_site_name("the hall"));
  EXPECT_FALSE(is_plain_site_name("the \"hall\""));
  EXPECT_FALSE(is_plain_site_name("the\nhall"));
  const auto refused = settle({{"a\\b", store("a\\b", "good")}});
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->kind, Kind::kRefused);
}

}  // namespace
}  // namespace rayloc::site_folder_test
