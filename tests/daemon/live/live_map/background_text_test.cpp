// A text that takes long is computed once at a time, and no request waits for it.
#include "daemon/live/live_map/background_text.h"

#include <atomic>
#include <future>

#include <gtest/gtest.h>

#include "tests/support/eventually.h"

namespace rayloc::background_text_test {
namespace {

constexpr std::chrono::seconds kPatience{60};

TEST(BackgroundText, AnswersAtOnceAndRecomputesForLaterRequests) {
  std::promise<void> release;
  std::shared_future<void> released = release.get_future().share();
  std::atomic<int> made = 0;
  BackgroundText text(
      [&] {
        const int number = ++made;
        released.wait();
        return std::to_string(number);
      },
      "none");
  EXPECT_EQ(text.ask(), "none");
  ASSERT_TRUE(eventually(kPatience, [&] { return made == 1; }));
  // While the first is computed, no request waits for it, and no second computation begins.
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(text.ask(), "none");
  }
  EXPECT_EQ(made, 1);
  EXPECT_FALSE(text.idle());
  release.set_value();
  // All requests in the meantime cause one more computation together.
  ASSERT_TRUE(eventually(kPatience, [&] { return made == 2; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return text.ask() >= "2"; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return text.idle(); }));
}

}  // namespace
}  // namespace rayloc::background_text_test
