#include "daemon/base/roff.h"

#include <gtest/gtest.h>

namespace rayloc::roff_test {
namespace {

TEST(Roff, EscapesBackslashesAndDashes) {
  EXPECT_EQ(roff("--out C:\\new"), "\\-\\-out C:\\enew");
  EXPECT_EQ(roff("plain text."), "plain text.");
  EXPECT_EQ(roff(""), "");
}

TEST(Roff, KeepsALineFromBeingARequest) {
  EXPECT_EQ(roff(".TH"), "\\&.TH");
  EXPECT_EQ(roff("'quoted'"), "\\&'quoted'");
  EXPECT_EQ(roff(" .5"), " .5") << "only the first character makes a request";
}

}  // namespace
}  // namespace rayloc::roff_test
