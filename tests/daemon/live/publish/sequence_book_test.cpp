#include "daemon/live/publish/sequence_book.h"

#include <gtest/gtest.h>

namespace rayloc::sequence_book_test {
namespace {

TEST(SequenceBook, CountsPerTopicAndPerClass) {
  SequenceBook book(10);
  EXPECT_EQ(book.next("v1/location/s/a/"), 1U);
  EXPECT_EQ(book.next("v1/location/s/a/"), 2U);
  EXPECT_EQ(book.next("v1/location/s/b/"), 1U);
  EXPECT_EQ(book.next("v1/track/s/"), 1U);
  const auto classes = book.classes(true);
  ASSERT_EQ(classes.size(), 2U);
  EXPECT_EQ(classes.at("v1/location/s/").published, 3U);
  EXPECT_EQ(classes.at("v1/location/s/").last.at("v1/location/s/a/"), 2U);
  EXPECT_EQ(classes.at("v1/track/s/").published, 1U);
  EXPECT_EQ(book.published(), 4U);
}

TEST(SequenceBook, ForgetsTheTopicThatWasUnusedLongest) {
  SequenceBook book(2);
  book.next("v1/location/s/a/");
  book.next("v1/location/s/b/");
  book.next("v1/location/s/a/");
  book.next("v1/location/s/c/");  // b goes
  EXPECT_EQ(book.next("v1/location/s/a/"), 3U);
  EXPECT_EQ(book.next("v1/location/s/b/"), 1U);  // c goes
  const auto classes = book.classes(false);
  EXPECT_EQ(classes.at("v1/location/s/").published, 6U);
  EXPECT_EQ(classes.at("v1/location/s/").last.size(), 2U);
}

TEST(SequenceBook, StaysBoundedForAnyNumberOfTopics) {
  SequenceBook book(100);
  for (int i = 0; i < 10'000; ++i) {
    book.next("v1/location/s/" + std::to_string(i) + "/");
  }
  EXPECT_EQ(book.classes(true).at("v1/location/s/").last.size(), 100U);
  EXPECT_EQ(book.published(), 10'000U);
}

}  // namespace
}  // namespace rayloc::sequence_book_test
