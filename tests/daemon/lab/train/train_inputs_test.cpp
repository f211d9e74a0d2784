#include "daemon/lab/train/train_inputs.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::train_inputs_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TrainOptions options() {
  TrainOptions options;
  options.site = test::data_path("/sites/meeting_room");
  options.method = "spotfi";
  return options;
}

Error error_of(const TrainOptions& options) {
  const auto inputs = read_train_inputs(options);
  EXPECT_FALSE(inputs);
  return inputs ? Error{} : inputs.error();
}

void expect_usage(const TrainOptions& options, const std::string& word) {
  const Error error = error_of(options);
  EXPECT_EQ(error.kind, ErrorKind::kUsage) << error.message;
  EXPECT_THAT(error.message, HasSubstr(word));
}

TEST(TrainInputs, ListsTheMethodsThatAreTrained) {
  EXPECT_THAT(trained_methods(), Contains("spotfi"));
  EXPECT_THAT(trained_methods(), Contains("cifi"));
  EXPECT_THAT(trained_methods(), Not(Contains("rayloc")));
}

TEST(TrainInputs, RefusesInvalidOptions) {
  TrainOptions method = options();
  method.method = "rayloc";
  expect_usage(method, "rayloc");
  method.method = "no_such_method";
  expect_usage(method, "no_such_method");
  TrainOptions holdout = options();
  holdout.holdout = 0.9;
  expect_usage(holdout, "--holdout");
  TrainOptions setting = options();
  setting.baseline = {"gird_m=5"};
  expect_usage(setting, "grid_m");
}

TEST(TrainInputs, SiteMustBeCalibrated) {
  const Error error = error_of(options());
  EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
  EXPECT_THAT(error.message, HasSubstr("rayloc calibrate"));
}

}  // namespace
}  // namespace rayloc::train_inputs_test
