#include "engine/base/csv_reader.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/printable.h"

namespace rayloc::csv_reader_test {
namespace {

using Rows = std::vector<std::vector<std::string>>;

Expected<Rows> read(std::string_view text) {
  CsvReader reader(text, "t.csv", ErrorKind::kBadInput, 8);
  Rows rows;
  CsvReader::Record record;
  while (true) {
    const auto more = reader.next(record);
    RAYLOC_TRY(more);
    if (!*more) {
      return rows;
    }
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < record.size(); ++i) {
      row.emplace_back(record[i]);
    }
  }
}

std::string error_of(std::string_view text) {
  const auto rows = read(text);
  return rows ? "read" : rows.error().message;
}

TEST(Field, CsvQuotesHoldSeparatorsQuotesAndLineEnds) {
  EXPECT_EQ(read("\"a\",\"b,c\" , \"say \"\"x\"\"\"\n\"two\r\nlines\",\"\",3\" pipe\n"),
            (Rows{{"a", "b,c", "say \"x\""}, {"two\r\nlines", "", "3\" pipe"}}));
}

TEST(Field, CsvPlacesCountLinesWithinQuotes) {
  CsvReader reader("\"a\nb\", c\nd,e\n", "t.csv", ErrorKind::kBadInput, 8);
  CsvReader::Record record;
  ASSERT_TRUE(reader.next(record).value());
  EXPECT_EQ(record.cells[0].line, 1);
  EXPECT_EQ(record.cells[1].line, 2);
  EXPECT_EQ(record.cells[1].column, 5U);
  ASSERT_TRUE(reader.next(record).value());
  EXPECT_EQ(record.cells[0].line, 3);
  EXPECT_FALSE(reader.next(record).value());
}

TEST(Field, CsvQuotesThatDoNotCloseNameTheirPlace) {
  EXPECT_EQ(error_of("a,b\n1, \"2\n3,4\n"),
            "t.csv:2:4: this quote is never closed; write \" at the end of the cell");
  EXPECT_EQ(error_of("a,\"b\"c\n"),
            "t.csv:1:6: text after a closing quote; a quote within one is written \"\"");
}

TEST(Field, CsvAllLineEndsAndSeparatorsAreRead) {
  const Rows rows{{"x", "y"}, {"1", "2"}};
  for (const char* text : {"x,y\n1,2\n",
                           "x,y\r\n1,2",
                           "x,y\r1,2\r",
                           "\xef\xbb\xbfx;y\n1;2\n",
                           "x\ty\n1\t2\n",
                           "sep=;\nx;y\n1;2\n",
                           "sep=|\r\nx|y\r\n1|2\r\n",
                           "# surveyed, on; Monday\n\n x , y\n#1,1\n1,2\n  \n"}) {
    EXPECT_EQ(read(text), rows) << text;
  }
  EXPECT_EQ(read("#,x\n1,2\n"), (Rows{{"#", "x"}, {"1", "2"}}));
}

TEST(Field, CsvSeparatorInQuotesDoesNotCount) {
  EXPECT_EQ(read("\"x, y, z\";name\n1;2\n"), (Rows{{"x, y, z", "name"}, {"1", "2"}}));
}

TEST(Field, CsvRefusesBinaryText) {
  const std::string little("\xff\xfex\0,\0", 6);
  const std::string without_mark("x\0,\0y\0", 6);
  for (const std::string& text : {little, without_mark}) {
    EXPECT_EQ(error_of(text), "t.csv:1:1: UTF-16, or no text; save it as \"CSV UTF-8\"");
  }
  EXPECT_EQ(error_of("1,2,3,4,5,6,7,8,9\n"), "t.csv:1:17: more than 8 cells in a line");
}

TEST(Field, CsvDecimalCommasAreReadWhereCommasPartNoCells) {
  EXPECT_EQ(parse_csv_number("-1,5400", ';'), -1.54);
  EXPECT_EQ(parse_csv_number("1.25", '\t'), 1.25);
  EXPECT_EQ(parse_csv_number("+4.0", ','), 4.0);
  EXPECT_EQ(parse_csv_number("1,25", ','), std::nullopt);
  for (const char* text : {"", "1.200,5", "1,2,3", "+-1", "inf", "1e999"}) {
    EXPECT_EQ(parse_csv_number(text, ';'), std::nullopt) << text;
  }
}

TEST(Field, PrintableTextHasNoControlCharacters) {
  EXPECT_EQ(printable("a\x1b[31m\n\x7f\xc2\x9b"
                      "b\xc3\xa4"),
            "a?[31m???b\xc3\xa4");
  EXPECT_EQ(printable("a\nb\r", '\n'), "a\nb?");
  EXPECT_EQ(quoted_cell(std::string(50, 'x') + "\n"), '"' + std::string(40, 'x') + "...\"");
}

}  // namespace
}  // namespace rayloc::csv_reader_test
