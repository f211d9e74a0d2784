// Tests the priority of bursts that the estimator of a real site gives.
#include <gtest/gtest.h>

#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/zones/zone_estimator.h"
#include "tests/support/test_paths.h"

namespace rayloc::field_rank_test {
namespace {

TEST(Field, DeviceEstimatorRanksTheTransmittersOfTheSiteFirst) {
  const Expected<Site> site = load_site(test::data_path("/sites/meeting_room"));
  ASSERT_TRUE(site) << site.error().message;
  const auto devices = DeviceEstimator::create(*site, {});
  ASSERT_TRUE(devices) << devices.error().message;
  EstimatorList all;
  all.add(**devices);
  const ZoneEstimator zones(all, {});
  for (const SiteTransmitter& transmitter : site->transmitters) {
    // No device has a track yet.
    EXPECT_EQ(
        zones.rank(transmitter.mac),
        transmitter.role == TransmitterRole::kFixed ? Rank::kListed : Rank::kListedAcquisition)
        << to_string(transmitter.mac);
  }
  EXPECT_GE(site->transmitters.size(), 2U);
  EXPECT_EQ(zones.rank({{0x02, 0x52, 0x4c, 0xff, 0, 1}}), Rank::kOther);
}

}  // namespace
}  // namespace rayloc::field_rank_test
