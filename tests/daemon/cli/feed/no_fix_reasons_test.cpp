#include "daemon/cli/feed/no_fix_reasons.h"

#include <gtest/gtest.h>

namespace rayloc::cli::no_fix_reasons_test {
namespace {

Location without_fix(const std::string& reason) {
  Location location;
  location.estimate.reason = reason;
  return location;
}

TEST(Field, ReasonsWithoutAFixAreCountedTheMostFrequentFirst) {
  NoFixReasons reasons;
  EXPECT_EQ(reasons.text(), "");
  Location located;
  located.estimate.position = Vec3d{1.0, 2.0, 1.2};
  Location filtered = without_fix("of a tracker");
  filtered.tracked = Tracked{};
  reasons.count(located);
  reasons.count(filtered);
  EXPECT_EQ(reasons.text(), "") << "no snapshot is without a fix";
  reasons.count(without_fix("no frames"));
  for (int i = 0; i < 30; ++i) {
    reasons.count(without_fix("no chain gains, calibrate the site"));
  }
  EXPECT_EQ(reasons.text(),
            "31 without a fix: no chain gains, calibrate the site (30); no frames (1)");
}

TEST(Field, RareReasonsWithoutAFixAreCountedTogether) {
  NoFixReasons reasons;
  for (int i = 0; i < 100; ++i) {
    reasons.count(without_fix("reason " + std::to_string(i)));
  }
  const std::string text = reasons.text();
  EXPECT_EQ(text.rfind("100 without a fix: reason 0 (1); ", 0), 0U) << text;
  EXPECT_NE(text.find("; other reasons (92)"), std::string::npos) << text;
}

TEST(Field, ProgressOfLearningIsOneReasonWithoutAFix) {
  NoFixReasons reasons;
  for (int i = 0; i < 12; ++i) {
    reasons.count(without_fix("learning the chains of ap1: " + std::to_string(i) +
                              " of at least 10 bursts; learning the chains of ap3: " +
                              std::to_string(2 * i) + " of at least 10 bursts"));
  }
  const std::string text = reasons.text();
  EXPECT_NE(text.find("learning the chains of ap1; learning the chains of ap3 (12)"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace rayloc::cli::no_fix_reasons_test
