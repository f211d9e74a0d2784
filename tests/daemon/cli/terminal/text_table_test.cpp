#include "daemon/cli/terminal/text_table.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::cli::text_table_test {
namespace {

TEST(TextTable, AlignsByCharacters) {
  TextTable table({"a", ">count", "b"});
  table.add({"\xc3\xbc\xc3\xbc", "7", ""});
  table.add({"x", "1234567", "y"});
  EXPECT_EQ(
      table.lines(),
      (std::vector<std::string>{"a     count  b", "\xc3\xbc\xc3\xbc        7", "x   1234567  y"}));
  EXPECT_EQ(cut("\xc3\xbc-\xc3\xbc", 2), "\xc3\xbc-");
  EXPECT_EQ(cut("abc", 3), "abc");
}

TEST(TextTable, OmitsTheLeastImportantColumnsWhenNarrow) {
  TextTable table({"name", ">x", ">z", "state"});
  table.may_lack({"z", "state"});
  table.add({"phone", "1.25", "0.90", "confirmed"});
  EXPECT_EQ(table.lines(28)[1], "phone  1.25  0.90  confirmed");
  EXPECT_EQ(table.lines(27)[1], "phone  1.25  confirmed");
  EXPECT_EQ(table.lines(21)[0], "name      x");
  EXPECT_EQ(table.lines(3)[1], "phone  1.25");
}

TEST(TextTable, BreaksSentencesAtSpaces) {
  EXPECT_EQ(wrapped("one two three", 8, 2), (std::vector<std::string>{"one two", "  three"}));
  EXPECT_EQ(wrapped("one two three", 13, 2), (std::vector<std::string>{"one two three"}));
  EXPECT_EQ(wrapped("immeasurable", 4, 2), (std::vector<std::string>{"immeasurable"}));
  EXPECT_EQ(wrapped("a immeasurable", 4, 2), (std::vector<std::string>{"a", "  immeasurable"}));
}

}  // namespace
}  // namespace rayloc::cli::text_table_test
