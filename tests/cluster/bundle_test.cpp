// `rayloc cluster apply` and `fetch` with a real server and a real worker: an applied site has an
// owner, another version replaces it, and an invalid version changes nothing.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/operate/site_bundle.h"
#include "tests/cluster/nats_server.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/patience.h"

namespace rayloc::cluster::bundle_test {
namespace {

namespace fs = std::filesystem;
using e2e::Process;
using e2e::read_text;
using e2e::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kPatience{60};

class Bundles : public ::testing::Test {
 protected:
  void SetUp() override {
    RAYLOC_NEEDS_NATS_SERVER();
    ASSERT_TRUE(server_.start());
    fs::create_directories(plan_);
    fs::copy(e2e::bundled("scene.xml"), plan_ / "scene.xml");
    fs::copy(e2e::bundled("meshes"), plan_ / "meshes");
    fs::copy(e2e::bundled("site.toml"), plan_ / "site.toml");
    std::ofstream(plan_ / "walk.pcap") << "a recording";
  }

  struct Outcome {
    int status = -1;
    std::string text;
  };
  Outcome rayloc(std::vector<std::string> words) const {
    Process process(folder_.path(), "rayloc", "rayloc", words);
    const int status = process.wait(kPatience).value_or(-1);
    return {status, read_text(process.out()) + process.errors()};
  }
  Outcome apply(const std::string& name = "hall") const {
    return rayloc({"cluster", "apply", plan_.string(), "--name", name, "--server", server_.url()});
  }
  Outcome remove(const std::string& name) const {
    return rayloc({"cluster", "remove", name, "--server", server_.url()});
  }
  std::vector<std::string> fetch_arguments() const {
    return {"cluster", "fetch", (folder_.path() / "sites").string(), "--server", server_.url()};
  }
  // Configuration of a worker with all applied sites.
  fs::path configuration() const {
    const std::string folder = folder_.path().string();
    std::ofstream(folder_.path() / "raylocd.toml")
        << "include = [\"sites/*.toml\"]\n[engine]\nmethod = \"none\"\n[publish]\nendpoint = "
           "\"ipc://"
        << folder << "/publish\"\nsnapshot = \"ipc://" << folder
        << "/snapshot\"\n[http]\nlisten = \"127.0.0.1:" << free_tcp_port()
        << "\"\n[cluster]\nrole = \"worker\"\nname = \"w1\"\nservers = [\"" << server_.url()
        << "\"]\nlease_s = 0.5\n";
    return folder_.path() / "raylocd.toml";
  }

  TemporaryFolder folder_;
  NatsServer server_{folder_.path()};
  fs::path plan_ = folder_.path() / "plan";
};

// Generations begin at the creation time of the stream of claims, so their numbers vary.
int times_owned(const Process& worker) {
  const std::string log = worker.errors();
  const std::string owned = "site 'hall' is owned, generation ";
  int times = 0;
  for (std::size_t at = log.find(owned); at != std::string::npos; at = log.find(owned, at + 1)) {
    ++times;
  }
  return times;
}

TEST_F(Bundles, ReachWorkersOnceTheyCheckAndGoWhenTheyAreRemoved) {
  ASSERT_EQ(apply("attic").status, 0);  // stays
  const Outcome applied = apply();
  ASSERT_EQ(applied.status, 0) << applied.text;
  EXPECT_THAT(applied.text, HasSubstr("site hall: "));
  const Outcome fetched = rayloc(fetch_arguments());
  ASSERT_EQ(fetched.status, 0) << fetched.text;
  EXPECT_THAT(fetched.text, HasSubstr("site 'hall' is there"));
  const fs::path hall = folder_.path() / "sites" / "hall";
  EXPECT_EQ(read_text(hall / "site.toml"), read_text(plan_ / "site.toml"));
  EXPECT_FALSE(fs::exists(hall / "walk.pcap"));
  EXPECT_THAT(rayloc(fetch_arguments()).text, Not(HasSubstr("is there")));  // nothing has changed

  Process worker(folder_.path(), "worker", "raylocd", {"--config", configuration().string()});
  ASSERT_TRUE(eventually(kPatience, [&] { return times_owned(worker) == 1; })) << worker.errors();
  std::vector<std::string> follow = fetch_arguments();
  follow.insert(follow.end(),
                {"--follow", "--command", "kill -HUP " + std::to_string(worker.pid())});
  Process follower(folder_.path(), "follow", "rayloc", follow);
  std::ofstream(plan_ / "site.toml", std::ios::app) << "# another one\n";
  const Outcome again = apply();
  ASSERT_EQ(again.status, 0) << again.text;
  EXPECT_TRUE(eventually(kPatience, [&] { return times_owned(worker) == 2; }))
      << worker.errors() << follower.errors();
  const std::string good = read_text(hall / "site.toml");
  EXPECT_THAT(good, HasSubstr("# another one"));

  // An invalid site is not applied; if it is stored all the same, `fetch` does not take it.
  std::ofstream(plan_ / "site.toml", std::ios::app) << "[bounds]\n";
  const Outcome refused = apply();
  EXPECT_EQ(refused.status, 78) << refused.text;
  EXPECT_THAT(refused.text, HasSubstr("not applied, what workers have goes on: "));
  const auto broker = *open_broker({{server_.url()}, "test"});
  ASSERT_TRUE(wait_for_broker(*broker, test::patient(kPatience)));
  const auto bad = read_bundle(plan_);
  ASSERT_TRUE(bad);
  ASSERT_TRUE(store_bundle(*broker, "hall", *bad, 1));
  EXPECT_TRUE(eventually(kPatience, [&] {
    return follower.errors().find("site 'hall' is left as it was: ") != std::string::npos;
  })) << follower.errors();
  EXPECT_EQ(read_text(hall / "site.toml"), good);

  const Outcome removed = remove("hall");
  EXPECT_EQ(removed.status, 0) << removed.text << worker.errors() << follower.errors();
  EXPECT_THAT(follower.errors(), HasSubstr("site 'hall' is taken out"));
  EXPECT_FALSE(fs::exists(hall));
  EXPECT_THAT(worker.errors(), HasSubstr("site 'hall' is not owned any more"));
  const Outcome left = rayloc({"cluster", "sites", "--server", server_.url()});
  EXPECT_THAT(left.text, HasSubstr("attic: worker w1"));
  EXPECT_THAT(left.text, Not(HasSubstr("hall")));
  EXPECT_FALSE(broker->stream_state("CSI_hall"));
  EXPECT_TRUE(broker->stream_state("CSI_attic"));
  const Outcome unknown = remove("hall");
  EXPECT_EQ(unknown.status, 69) << unknown.text;
  EXPECT_THAT(unknown.text, HasSubstr("no site 'hall' was applied or claimed"));
  // A site that is applied again under this name has an owner again.
  std::ofstream(plan_ / "site.toml") << good;
  ASSERT_EQ(apply().status, 0);
  EXPECT_TRUE(eventually(kPatience, [&] { return times_owned(worker) == 3; })) << worker.errors();
  follower.signal(SIGTERM);
  EXPECT_EQ(follower.wait(kPatience), 0);
  worker.signal(SIGTERM);
  EXPECT_EQ(worker.wait(kPatience), 0);
}

TEST(SiteBundle, WritesNothingOutsideOfItsFolder) {
  const TemporaryFolder folder;
  SiteBundle bundle;
  bundle.files["../outside"] = "x";
  EXPECT_FALSE(write_bundle(bundle, folder.path() / "in"));
  bundle.files = {{"/tmp/outside", "x"}};
  EXPECT_FALSE(write_bundle(bundle, folder.path() / "in"));
  bundle.files = {{"a", "bc"}};
  const std::string hash = bundle.hash();
  bundle.files = {{"ab", "c"}};
  EXPECT_NE(bundle.hash(), hash);
  fs::create_symlink("/etc/passwd", folder.path() / "link");
  EXPECT_FALSE(read_bundle(folder.path()));
}

}  // namespace
}  // namespace rayloc::cluster::bundle_test
