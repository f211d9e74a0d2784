// Tests the endpoint from which `rayloc top` requests the last messages.
#include "daemon/cli/feed/top_snapshot.h"

#include <gtest/gtest.h>

namespace rayloc::cli::top_snapshot_test {
namespace {

TEST(UsualSnapshot, ExistsOnlyForTheUsualPort) {
  EXPECT_EQ(usual_snapshot("tcp://127.0.0.1:5560"), "tcp://127.0.0.1:5561");
  EXPECT_EQ(usual_snapshot("tcp://[::1]:5560"), "tcp://[::1]:5561");
  EXPECT_EQ(usual_snapshot("tcp://office.example:5560"), "tcp://office.example:5561");
  for (const char* other :
       {"tcp://127.0.0.1:5570", "tcp://127.0.0.1:15560", "ipc:///run/x:5560", "tcp://:5560", ""}) {
    EXPECT_FALSE(usual_snapshot(other)) << other;
  }
}

}  // namespace
}  // namespace rayloc::cli::top_snapshot_test
