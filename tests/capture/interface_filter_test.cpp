#include "capture/transport/interface_filter.h"

#include <map>

#include <gtest/gtest.h>

namespace rayloc::interface_filter_test {
namespace {

using namespace std::chrono_literals;

class Interfaces : public ::testing::Test {
 protected:
  InterfaceFilter filter(const std::string& name) {
    return {name,
            [this](const std::string& wanted) {
              ++look_ups_;
              const auto found = numbers_.find(wanted);
              return found == numbers_.end() ? 0U : found->second;
            },
            [this] { return now_; }};
  }

  std::map<std::string, unsigned> numbers_ = {{"lo", 1}, {"br0", 7}};
  InterfaceFilter::Time now_{1000s};
  int look_ups_ = 0;
};

TEST_F(Interfaces, WithoutANameEveryInterfaceIsAccepted) {
  InterfaceFilter any = filter("");
  EXPECT_TRUE(any.exists());
  EXPECT_TRUE(any.admits(1));
  EXPECT_TRUE(any.admits(99));
  EXPECT_EQ(look_ups_, 0);
}

TEST_F(Interfaces, ARecreatedInterfaceIsRecognised) {
  InterfaceFilter bridge = filter("br0");
  EXPECT_TRUE(bridge.admits(7));
  EXPECT_FALSE(bridge.admits(1));
  numbers_["br0"] = 12;  // ip link delete, ip link add
  now_ += 1s;
  EXPECT_TRUE(bridge.admits(12));
  EXPECT_TRUE(bridge.admits(12));
  EXPECT_FALSE(bridge.admits(7)) << "the number is nobody's, or another's, by now";
}

TEST_F(Interfaces, AnAbsentInterfaceAdmitsNothingUntilItReturns) {
  InterfaceFilter bridge = filter("br0");
  numbers_.erase("br0");
  now_ += 1s;
  EXPECT_FALSE(bridge.admits(1));
  EXPECT_FALSE(bridge.exists());
  EXPECT_FALSE(bridge.admits(12));
  numbers_["br0"] = 12;
  now_ += 1s;
  EXPECT_TRUE(bridge.admits(12));
}

TEST_F(Interfaces, AFloodOnAnotherInterfaceCostsOneQueryASecond) {
  InterfaceFilter bridge = filter("br0");
  for (int i = 0; i < 3000; ++i) {
    EXPECT_FALSE(bridge.admits(1));
    now_ += 1ms;
  }
  EXPECT_LE(look_ups_, 4) << "at the start, then once a second";
}

}  // namespace
}  // namespace rayloc::interface_filter_test
