#include "daemon/cli/terminal/line_input.h"

#include <unistd.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::cli::line_input_test {
namespace {

class LineInputTest : public ::testing::Test {
 protected:
  LineInputTest() : ends_(open_pipe()), input_(ends_[0]) {}
  ~LineInputTest() override {
    ::close(ends_[0]);
    close_input();
  }
  LineInputTest(const LineInputTest&) = delete;
  LineInputTest& operator=(const LineInputTest&) = delete;

  void type(std::string_view text) const {
    EXPECT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void close_input() {
    if (ends_[1] >= 0) {
      ::close(ends_[1]);
      ends_[1] = -1;
    }
  }
  std::vector<std::string> lines() {
    input_.poll();
    std::vector<std::string> taken;
    for (; input_.front() != nullptr; input_.pop()) {
      taken.push_back(*input_.front());
    }
    return taken;
  }

  static std::array<int, 2> open_pipe() {
    std::array<int, 2> ends{-1, -1};
    EXPECT_EQ(::pipe(ends.data()), 0);
    return ends;
  }

  std::array<int, 2> ends_;  // to read from, to write to
  LineInput input_;
};

using Lines = std::vector<std::string>;

TEST_F(LineInputTest, ReturnsAtOnceWithoutInput) {
  EXPECT_EQ(lines(), Lines());
  EXPECT_FALSE(input_.ended());
}

TEST_F(LineInputTest, SplitsLinesOfBothKinds) {
  type("one\ntwo\r\n\nthree\n");
  EXPECT_EQ(lines(), (Lines{"one", "two", "", "three"}));
}

TEST_F(LineInputTest, JoinsALineThatComesInParts) {
  type("on");
  EXPECT_EQ(lines(), Lines());
  type("e\ntw");
  EXPECT_EQ(lines(), Lines{"one"});
  type("o\n");
  EXPECT_EQ(lines(), Lines{"two"});
}

TEST_F(LineInputTest, ReadsALineThatIsLongerThanItsBuffer) {
  const std::string line(5000, 'x');
  type(line + "\n");
  EXPECT_EQ(lines(), Lines{line});
}

TEST_F(LineInputTest, DeliversTheLastLineWithoutItsEnd) {
  type("one\ntwo");
  close_input();
  EXPECT_EQ(lines(), (Lines{"one", "two"}));
  EXPECT_TRUE(input_.ended());
  EXPECT_EQ(lines(), Lines());
}

TEST_F(LineInputTest, HasNoLineAfterTheLastLineEnd) {
  type("one\n");
  close_input();
  EXPECT_EQ(lines(), Lines{"one"});
  EXPECT_TRUE(input_.ended());
}

}  // namespace
}  // namespace rayloc::cli::line_input_test
