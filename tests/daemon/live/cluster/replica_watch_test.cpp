#include "daemon/live/cluster/operate/replica_watch.h"

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/daemon/live/cluster/fake_broker.h"
#include "tests/support/eventually.h"

namespace rayloc::replica_watch_test {
namespace {

constexpr std::chrono::seconds kPatience{20};

constexpr const char* kStreams = R"({"total": 3, "streams": [
  {"config": {"name": "CSI_hall", "num_replicas": 3}, "cluster": {"leader": "n1", "replicas": [
    {"name": "n2", "offline": true}, {"name": "n3", "current": false, "lag": 12}]}},
  {"config": {"name": "OUT", "num_replicas": 3}, "cluster": {"leader": "", "replicas": [
    {"name": "n2", "current": true}]}},
  {"config": {"name": "CLAIMS", "num_replicas": 1}}]})";

TEST(ReplicaWatch, CountsReplicasThatAreOfflineOrBehind) {
  const auto broker = std::make_shared<FakeBroker>();
  broker->answer = [](const std::string& subject) {
    return subject == "$JS.API.STREAM.LIST" ? kStreams : "{}";
  };
  ReplicaWatch watch(broker, std::chrono::milliseconds(10));
  EXPECT_FALSE(watch.faults());
  watch.start();
  const std::map<std::string, std::size_t> expected = {{"CLAIMS", 0}, {"CSI_hall", 2}, {"OUT", 1}};
  EXPECT_TRUE(eventually(kPatience, [&] { return watch.faults() == expected; }));
  broker->set_connected(false);
  EXPECT_TRUE(eventually(kPatience, [&] { return !watch.faults(); }))
      << "an old answer is no state";
  broker->set_connected(true);
  EXPECT_TRUE(eventually(kPatience, [&] { return watch.faults() == expected; }));
  watch.finish();
}

}  // namespace
}  // namespace rayloc::replica_watch_test
