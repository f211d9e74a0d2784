#include "daemon/lab/reference/reference_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::reference_inputs_test {
namespace {

using ::testing::HasSubstr;

ReferenceOptions options() {
  ReferenceOptions options;
  options.site = test::data_path("/sites/meeting_room");
  options.captures = {"ap1=empty.pcap"};
  return options;
}

Error error_of(const ReferenceOptions& options) {
  const auto inputs = read_reference_inputs(options, {});
  EXPECT_FALSE(inputs);
  return inputs ? Error{} : inputs.error();
}

TEST(ReferenceInputs, PeopleAndPointsBelongTogether) {
  ReferenceOptions people = options();
  people.people = {"ap1=people.pcap"};
  EXPECT_EQ(error_of(people).kind, ErrorKind::kUsage);
  EXPECT_THAT(error_of(people).message, HasSubstr("--points"));
  ReferenceOptions points = options();
  points.points = "places.csv";
  EXPECT_EQ(error_of(points).kind, ErrorKind::kUsage);
}

TEST(ReferenceInputs, AnotherDayNeedsPeople) {
  ReferenceOptions day = options();
  day.people_empty = {"ap1=empty.pcap"};
  EXPECT_EQ(error_of(day).kind, ErrorKind::kUsage);
  EXPECT_THAT(error_of(day).message, HasSubstr("--people-empty"));
}

TEST(ReferenceInputs, SiteMustBeCalibrated) {
  const Error error = error_of(options());
  EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
  EXPECT_THAT(error.message, HasSubstr("rayloc calibrate"));
}

}  // namespace
}  // namespace rayloc::reference_inputs_test
