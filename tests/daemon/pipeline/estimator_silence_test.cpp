// Tests that the estimators report no silence of a transmitter whose bursts wait.
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include <gmock/gmock.h>

#include "daemon/methods/person_method.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/person_estimator.h"
#include "tests/daemon/pipeline/fake_devices.h"
#include "tests/support/test_paths.h"

namespace rayloc::estimator_silence_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Timestamp kBegin(std::chrono::milliseconds(100'050));
const Timestamp kLater = kBegin + std::chrono::seconds(2);

bool none_waits(const MacAddress& /*transmitter*/) { return false; }
bool all_wait(const MacAddress& /*transmitter*/) { return true; }

MacAddress plug(std::uint8_t number) { return {{0x02, 0, 0, 0, 0, number}}; }

// Reports at each advance() that its transmitter is silent.
class SilentPerson : public PersonMethod {
 public:
  explicit SilentPerson(std::uint64_t number) : number_(number) {}
  std::vector<LocationEstimate> locate(std::span<const CsiFrame> /*frames*/,
                                       std::uint64_t /*repeat*/) const override {
    return {};
  }
  void advance(Timestamp now, std::vector<PersonUpdate>& updates) override {
    PersonUpdate& update = updates.emplace_back();
    update.track = number_;
    update.estimate.location.time = now;
  }

 private:
  const std::uint64_t number_;
};

Expected<std::unique_ptr<PersonMethod>> make_silent_person(PersonMethodInput input) {
  return std::make_unique<SilentPerson>(input.first_number);
}
constexpr Method kSilentPeople = {
    .name = "fake", .summary = "", .domain = "", .create_person = &make_silent_person};

// The numbers of the people whose transmitters are reported as silent.
std::vector<std::uint64_t> silent_people(Estimator& people, const IsWaiting& is_waiting) {
  Estimates out;
  people.advance(kLater, is_waiting, out);
  std::vector<std::uint64_t> numbers;
  for (const Location& location : out.locations) {
    numbers.push_back(location.target.track.value_or(0));
  }
  return numbers;
}

TEST(PersonEstimator, ReportsNoSilenceOfATransmitterThatWaits) {
  Site site;
  std::vector<PersonReference> references;
  for (const std::uint8_t number : {std::uint8_t{1}, std::uint8_t{2}}) {
    SiteTransmitter& fixed = site.transmitters.emplace_back();
    fixed.role = TransmitterRole::kFixed;
    fixed.mac = plug(number);
    references.emplace_back().mac = plug(number);
  }
  PersonEstimator::Options options;
  options.method = &kSilentPeople;
  const auto people = PersonEstimator::create(
      site, options, std::make_shared<const RoomModel>(test::make_room()), references);
  ASSERT_TRUE(people) << people.error().message;
  EstimatorList list;
  list.add(**people);
  const auto first_waits = [](const MacAddress& transmitter) { return transmitter == plug(1); };
  EXPECT_THAT(silent_people(list, none_waits), ElementsAre(1U, 2U));
  EXPECT_THAT(silent_people(list, first_waits), ElementsAre(2U));
  EXPECT_THAT(silent_people(list, all_wait), IsEmpty());
}

TEST(DeviceEstimator, ReportsNoSilenceOfADeviceThatWaits) {
  const Expected<Site> site = load_site(test::data_path("/sites/meeting_room"));
  ASSERT_TRUE(site) << site.error().message;
  DeviceEstimator::Options options;
  options.method = &test::kFakeDevices;
  const auto devices = DeviceEstimator::create(*site, options);
  ASSERT_TRUE(devices) << devices.error().message;
  EstimatorList list;
  list.add(**devices);
  Estimates received;
  list.estimate(test::burst_of(2, kBegin), received);
  ASSERT_THAT(received.locations, SizeIs(2)) << "a snapshot and an estimate of its track";
  Estimates silent;
  list.advance(kLater, none_waits, silent);
  EXPECT_THAT(silent.locations, SizeIs(1));
  Estimates waiting;
  list.advance(kLater, all_wait, waiting);
  EXPECT_THAT(waiting.locations, IsEmpty());
}

}  // namespace
}  // namespace rayloc::estimator_silence_test
