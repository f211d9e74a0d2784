#include "daemon/base/observer.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::observer_test {
namespace {

TEST(Observer, PassesProgressAndNotesInOrder) {
  std::vector<std::pair<double, std::string>> progress;
  std::vector<std::string> notes;
  Observer observer;
  observer.on_progress = [&](double share, const std::string& stage) {
    progress.emplace_back(share, stage);
  };
  observer.on_note = [&](const std::string& note) { notes.push_back(note); };
  observer.progress(0.25, "first");
  observer.note("a");
  observer.progress(1.0, "second");
  observer.note("b");
  EXPECT_EQ(progress,
            (std::vector<std::pair<double, std::string>>{{0.25, "first"}, {1.0, "second"}}));
  EXPECT_EQ(notes, (std::vector<std::string>{"a", "b"}));
}

TEST(Observer, IsSilentWithoutFunctions) {
  const Observer observer;
  EXPECT_NO_THROW(observer.progress(0.5, "stage"));
  EXPECT_NO_THROW(observer.note("note"));
}

}  // namespace
}  // namespace rayloc::observer_test
