// `method` as a text and as an array: who locates, who is compared, and what is refused where.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/live/config/config.h"
#include "daemon/live/config/config_schema.h"
#include "daemon/live/config/engine_options.h"
#include "daemon/methods/method_registry.h"
#include "daemon/methods/track_options.h"
#include "engine/track/track.h"
#include "tests/support/edited_text.h"
#include "tests/support/test_paths.h"

namespace rayloc::config_methods_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const std::string kSite = test::data_path("/sites/meeting_room");

class MethodsOfAConfig : public ::testing::Test {
 public:
  MethodsOfAConfig()
      : file_(fs::path(::testing::TempDir()) / ("methods-" + std::to_string(getpid()) + ".toml")) {}
  ~MethodsOfAConfig() override { fs::remove(file_); }
  MethodsOfAConfig(const MethodsOfAConfig&) = delete;
  MethodsOfAConfig& operator=(const MethodsOfAConfig&) = delete;

 protected:
  // `method`: the value; `site`: keys of [site].
  Expected<DaemonSetup> load(const std::string& method, const std::string& site = "") {
    std::ofstream(file_) << text(method, site);
    return load_daemon_setup(file_);
  }
  static std::string text(const std::string& method, const std::string& site = "") {
    return "[engine]\nmethod = " + method + "\n[site]\ndirectory = \"" + kSite + "\"\n" + site +
           "[[source]]\naccess_point = \"ap1\"\nkind = \"udp\"\n";
  }
  // "methods.toml:2:10: ...", of a configuration that cannot be used.
  std::string errors_of(const std::string& whole) {
    std::ofstream(file_) << whole;
    const Expected<DaemonSetup> setup = load_daemon_setup(file_);
    return setup ? "" : testing::edited_text(setup.error().message, file_.string(), "methods.toml");
  }
  std::string errors(const std::string& method, const std::string& site = "") {
    return errors_of(text(method, site));
  }
  const fs::path file_;
};

const EngineConfig& engine_of(const Expected<DaemonSetup>& setup) {
  return setup.value().sites.front().config.engine;
}

TEST_F(MethodsOfAConfig, TheFirstLocatesAndTheOthersAreCompared) {
  const auto setup = load(R"(["rayloc", "spotfi"])");
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(engine_of(setup).method, find_method("rayloc"));
  EXPECT_THAT(engine_of(setup).compared, ElementsAre(find_method("spotfi")));
  EXPECT_THAT(setup->sites[0].method_places,
              ElementsAre(EndsWith(".toml:2:11: "), EndsWith(".toml:2:21: ")));
  const auto other = load(R"(["spotfi", "rayloc"])");
  EXPECT_EQ(engine_of(other).method, find_method("spotfi"));
  EXPECT_THAT(engine_of(other).compared, ElementsAre(find_method("rayloc")));
}

TEST_F(MethodsOfAConfig, AnArrayOfOneIsItsText) {
  const auto text = load("\"spotfi\"");
  const auto array = load("[\"spotfi\"]");
  for (const auto* setup : {&text, &array}) {
    ASSERT_TRUE(*setup) << setup->error().message;
    EXPECT_EQ(engine_of(*setup).method, find_method("spotfi"));
    EXPECT_THAT(engine_of(*setup).compared, IsEmpty());
  }
  EXPECT_THAT(text->values.changes_to(array->values).needs_restart, IsEmpty());
}

TEST_F(MethodsOfAConfig, ASiteHasItsOwn) {
  const auto setup = load("\"rayloc\"", "method = [\"spotfi\", \"rayloc\"]\n");
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(engine_of(setup).method, find_method("spotfi"));
  EXPECT_THAT(engine_of(setup).compared, ElementsAre(find_method("rayloc")));
  EXPECT_TRUE(load(R"(["rayloc", "m3"])"));
  const auto single = load(R"(["rayloc", "spotfi"])", "method = \"rayloc\"\n");
  ASSERT_TRUE(single) << single.error().message;
  EXPECT_THAT(engine_of(single).compared, IsEmpty());
}

TEST(EngineOptions, TracksReachTheMethodsThatHaveThem) {
  EngineConfig engine;
  engine.accuracy_confidence = 0.9;
  for (const std::string_view tracks : kTracksValues) {
    engine.tracks = tracks;
    const MethodOptions options = engine_options(*find_method("rayloc"), engine);
    EXPECT_EQ(options.accuracy_confidence, 0.9);
    EXPECT_EQ(track_options(options).uses_cloud, tracks == kCloudTracks) << tracks;
    EXPECT_THAT(engine_options(*find_method("spotfi"), engine).values, IsEmpty());
  }
}

TEST_F(MethodsOfAConfig, ReportsInvalidMethodsWithTheirPosition) {
  EXPECT_THAT(errors(R"(["rayloc", "spotfy"])"), StartsWith("methods.toml:2:21: 'spotfy'"));
  EXPECT_THAT(errors(R"(["rayloc", "spotfy"])"), HasSubstr("did you mean 'spotfi'?"));
  EXPECT_THAT(errors(R"(["rayloc", "spotfi", "rayloc"])"),
              StartsWith("methods.toml:2:31: method 'rayloc' is listed twice"));
  EXPECT_THAT(errors(R"(["rayloc", "paper"])"), StartsWith("methods.toml:2:21: method 'paper'"));
  EXPECT_THAT(errors(R"(["rayloc", "paper"])"), HasSubstr("rayloc replay --method paper"));
  EXPECT_THAT(errors(R"(["m3", "rayloc"])"), StartsWith("methods.toml:2:17: 'm3' takes frames"));
  EXPECT_THAT(errors("\"witraj\""), StartsWith("methods.toml:2:10: method 'witraj'"));
  EXPECT_THAT(errors(R"(["none", "rayloc"])"), StartsWith("methods.toml:2:11: 'none'"));
  EXPECT_THAT(errors("[]"), StartsWith("methods.toml:2:10: 'method' is an empty array"));
  EXPECT_THAT(errors(R"(["rayloc", 1])"), StartsWith("methods.toml:2:21: 'method'"));
  EXPECT_THAT(errors("\"rayloc\"", "method = [\"spotfi\", \"spotfi\"]\n"),
              StartsWith("methods.toml:5:21: method 'spotfi' is listed twice"));
}

TEST_F(MethodsOfAConfig, AMethodThatHasLearnedNothingOfTheSiteIsRefused) {
  const std::string error = errors(R"(["rayloc", "cifi"])");
  EXPECT_THAT(error, StartsWith("methods.toml:2:21: method 'cifi' has no training"));
  EXPECT_THAT(error, HasSubstr("rayloc train " + kSite + " --method cifi"));
  EXPECT_THAT(errors("\"rayloc\"", "method = \"dscp\"\n"),
              StartsWith("methods.toml:5:10: method 'dscp' has no training"));
}

// The bundled site without its device.
class SiteWithoutDevices {
 public:
  SiteWithoutDevices()
      : folder_(fs::path(::testing::TempDir()) / ("methods-site-" + std::to_string(getpid()))) {
    fs::create_directory(folder_);
    for (const auto& entry : fs::directory_iterator(kSite)) {
      if (entry.path().filename() != "site.toml") {
        fs::create_symlink(entry.path(), folder_ / entry.path().filename());
      }
    }
    std::ifstream in(fs::path(kSite) / "site.toml");
    std::string text(std::istreambuf_iterator<char>(in), {});
    const std::size_t device = text.find("[[transmitter]]");
    text.erase(device, text.find("[[transmitter]]", device + 1) - device);
    std::ofstream(folder_ / "site.toml")
        << testing::edited_text(text, "[targets]\n", "[targets]\nunlisted = \"ignore\"\n");
  }
  ~SiteWithoutDevices() { fs::remove_all(folder_); }
  SiteWithoutDevices(const SiteWithoutDevices&) = delete;
  SiteWithoutDevices& operator=(const SiteWithoutDevices&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  const fs::path folder_;
};

TEST_F(MethodsOfAConfig, AMethodNeedsTargetsOfItsKind) {
  const SiteWithoutDevices site;
  const std::string error = errors_of("[site]\ndirectory = \"" + site.folder().string() +
                                      "\"\nmethod = [\"rayloc\", \"spotfi\"]\n[[source]]\n"
                                      "access_point = \"ap1\"\nkind = \"udp\"\n");
  EXPECT_THAT(error, StartsWith("methods.toml:3:21: method 'spotfi' locates devices"));
  EXPECT_THAT(error, HasSubstr("role = \"device\""));
}

TEST_F(MethodsOfAConfig, AWorkerLocatesByOneMethod) {
  const std::string worker = "[[site]]\nname = \"x\"\ndirectory = \"" + kSite +
                             "\"\n[cluster]\nrole = \"worker\"\nservers = "
                             "[\"nats://127.0.0.1:4222\"]\nname = \"hall-1\"\n[engine]\nmethod = ";
  EXPECT_EQ(errors_of(worker + "\"rayloc\"\n"), "");
  EXPECT_THAT(errors_of(worker + "[\"rayloc\", \"spotfi\"]\n"),
              StartsWith("methods.toml:9:21: a worker of a cluster"));
}

TEST_F(MethodsOfAConfig, AChangeOfTheListNeedsTheSameRestartAsAChangeOfTheMethod) {
  const auto before = load("\"rayloc\"");
  const auto after = load(R"(["rayloc", "spotfi"])");
  EXPECT_THAT(before->values.changes_to(after->values).needs_restart, ElementsAre("engine.method"));
  EXPECT_EQ(nlohmann::json::parse(before->values.json()).at("engine.method"), "rayloc");
  EXPECT_EQ(nlohmann::json::parse(after->values.json()).at("engine.method"),
            nlohmann::json({"rayloc", "spotfi"}));
  const Expected<std::string> shown = effective_config(file_);
  ASSERT_TRUE(shown) << shown.error().message;
  EXPECT_THAT(*shown, HasSubstr("method = [\"rayloc\", \"spotfi\"]\n"));
}

TEST_F(MethodsOfAConfig, TheSchemaAllowsATextOrAnArray) {
  const auto schema = nlohmann::json::parse(config_json_schema());
  const auto& method = schema.at("properties").at("engine").at("properties").at("method");
  ASSERT_EQ(method.at("anyOf").size(), 2U);
  const auto& names = method.at("anyOf").at(0).at("enum");
  const auto& several = method.at("anyOf").at(1);
  EXPECT_EQ(names.back(), "none");
  EXPECT_EQ(several.at("items").at("enum").size() + 1, names.size());
  EXPECT_EQ(several.at("maxItems"), kMaxMethods);
  EXPECT_EQ(several.at("uniqueItems"), true);
}

}  // namespace
}  // namespace rayloc::config_methods_test
