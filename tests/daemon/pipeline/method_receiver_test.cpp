#include "daemon/pipeline/method_receiver.h"

#include <gtest/gtest.h>

namespace rayloc::method_receiver_test {
namespace {

Site make_site() {
  Site site;
  site.access_points.resize(1);
  site.carrier.bandwidth_mhz = 80;
  return site;
}

constexpr Method kOneChannel = {.name = "one", .summary = "", .domain = ""};
constexpr Method kEveryChannel = {
    .name = "every", .summary = "", .domain = "", .uses_every_channel = true};

TEST(MethodReceiver, AcceptsTheChannelsThatTheMethodUses) {
  const Site site = make_site();
  EXPECT_FALSE(receiver_options(site, 0, &kOneChannel).accepts_hops);
  EXPECT_TRUE(receiver_options(site, 0, &kEveryChannel).accepts_hops);
  EXPECT_TRUE(receiver_options(site, 0, &kEveryChannel).channel.has_value());
}

TEST(MethodReceiver, AcceptsAllCsiWhereNothingIsLocated) {
  const CsiReceiverOptions options = receiver_options(make_site(), 0, nullptr);
  EXPECT_FALSE(options.channel.has_value());
  EXPECT_FALSE(options.reject_mixture);
  EXPECT_FALSE(options.accepts_hops);
}

}  // namespace
}  // namespace rayloc::method_receiver_test
