#include "daemon/site/survey/points_csv.h"

#include <sys/resource.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "daemon/site/survey/csv_table.h"
#include "tests/support/test_paths.h"

namespace rayloc::points_csv_test {
namespace {

using namespace std::chrono_literals;

Expected<std::vector<SurveyPoint>> read(const std::string& text) {
  const auto table = CsvTable::parse(text, "p.csv");
  RAYLOC_TRY(table);
  return read_points(*table);
}

TEST(DecimalSeconds, AreExactToTheNanosecond) {
  EXPECT_EQ(parse_decimal_seconds("1718000125.3680"), 1718000125s + 368ms);
  EXPECT_EQ(parse_decimal_seconds("1718000125.123456789"), 1718000125s + 123456789ns);
  EXPECT_EQ(parse_decimal_seconds("0.0000000005"), 1ns);
  EXPECT_EQ(parse_decimal_seconds("0.00000000049999"), 0ns);
  EXPECT_EQ(parse_decimal_seconds("0.9999999999"), 1s);
  EXPECT_EQ(parse_decimal_seconds("-0.5"), -500ms);
  EXPECT_EQ(parse_decimal_seconds("+7"), 7s);
  EXPECT_EQ(parse_decimal_seconds(".25"), 250ms);
  EXPECT_EQ(parse_decimal_seconds("3."), 3s);
}

TEST(DecimalSeconds, RefuseInvalidNumbers) {
  for (const char* text : {"",
                           ".",
                           "-",
                           "1e9",
                           "1.2.3",
                           " 1",
                           "1 ",
                           "nan",
                           "0x10",
                           "--1",
                           "9223372036",
                           "99999999999999999999999"}) {
    EXPECT_EQ(parse_decimal_seconds(text), std::nullopt) << text;
  }
}

TEST(PointsCsv, ReadsTheSurveyOfTheBundledSite) {
  const auto points = load_points_csv(test::data_path("/sites/meeting_room/device_los.csv"));
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_GT(points->size(), 1U);
  EXPECT_EQ(points->front().t_start.time_since_epoch(), 1718000958s + 533200us);
  EXPECT_EQ(points->front().t_end.time_since_epoch(), 1718000959s + 539ms);
  EXPECT_EQ(points->front().position, (Vec3d{0.4933, 0.8713, 1.2031}));
  EXPECT_EQ(points->front().line, 2);
}

TEST(PointsCsv, FindsColumnsByNameAndIgnoresOthers) {
  const auto points = read("\xef\xbb\xbfname, z,y ,x,t_end,t_start\r\n\r\ndoor,3,2,1, 20 ,10\r\n");
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 1U);
  EXPECT_EQ(points->front().position, (Vec3d{1, 2, 3}));
  EXPECT_EQ(points->front().t_end.time_since_epoch(), 20s);
  EXPECT_EQ(points->front().line, 3);
}

TEST(PointsCsv, ErrorsNameFileLineAndColumn) {
  const std::string header = "t_start,t_end,x,y,z\n";
  EXPECT_EQ(read("").error().message, "p.csv:1:1: empty; the first line names the columns");
  EXPECT_EQ(read("t_start,x,y\n").error().message,
            "p.csv:1:1: no column t_end, z; the first line names the columns: t_start,t_end,x,y,z");
  EXPECT_EQ(read(header + "1,2,3,4\n").error().message,
            "p.csv:2:1: 4 values, but the header has 5 columns");
  EXPECT_EQ(read(header + "1,2,0,0,0\n\n1,2, 3m,4,5\n").error().message,
            "p.csv:4:6: \"3m\" is not a number");
  EXPECT_EQ(read(header + "1,2,inf,4,5\n").error().message, "p.csv:2:5: \"inf\" is not a number");
  EXPECT_EQ(read(header + "today,2,3,4,5\n").error().message,
            "p.csv:2:1: \"today\" is not a time; write seconds since 1970 as a decimal number");
  EXPECT_EQ(read(header + "2,1,3,4,5\n").error().message,
            "p.csv:2:3: t_end is before t_start; exchange them");
}

const std::string kHeader = "t_start,t_end,x,y,z\n";

// One survey as several spreadsheet programs write it.
TEST(Field, PointsOfEverySpreadsheetAreThoseOfTheSurvey) {
  for (const char* text :
       {"\"t_start\",\"t_end\",\"x\",\"y\",\"z\"\n\"10.5\",\"11\",\"-1.54\",\"2\",\"1.2\"\n",
        "T_start,t_end,X,y,z\n10.5,11,-1.54,2,1.2\n",
        "# surveyed on Monday\nt_start,t_end,x,y,z\n10.5,11,-1.54,2,1.2\n",
        "t_start,t_end,x,y,z\r10.5,11,-1.54,2,1.2\r",
        "t_start;t_end;x;y;z\n10,5;11;-1,54;2;1,2\n",
        "t_start;t_end;x;y;z\r\n10.5;11;-1.54;2;1.2\r\n",
        "sep=,\nt_start,t_end,x,y,z\n10.5,11,-1.54,2,1.2\n",
        "t_start\tt_end\tx\ty\tz\n10.5\t11\t-1.54\t2\t1.2\n",
        "t_start,t_end,x,y,z,\n10.5,11,-1.54,2,1.2,\n,,,,,\n",
        "t_start,t_end,x,y,z\n10.5,11,-1.54,2,1.2,,\n"}) {
    const auto points = read(text);
    ASSERT_TRUE(points) << text << points.error().message;
    ASSERT_EQ(points->size(), 1U) << text;
    EXPECT_EQ(points->front().t_start.time_since_epoch(), 10500ms) << text;
    EXPECT_EQ(points->front().t_end.time_since_epoch(), 11s) << text;
    EXPECT_EQ(points->front().position, (Vec3d{-1.54, 2, 1.2})) << text;
  }
}

TEST(Field, PointsThatASpreadsheetHasRoundedAreRefused) {
  EXPECT_EQ(
      read(kHeader + "1.71800E+09,1.71800E+09,1,2,3\n").error().message,
      "p.csv:2:1: \"1.71800E+09\" is not a time; write seconds since 1970 as a decimal number "
      "with all its digits, not as a spreadsheet rounds it");
  EXPECT_EQ(read("t_start,t_end,x,y,z,X\n1,2,3,4,5,6\n").error().message,
            "p.csv:1:1: two columns are called x; rename the one that is not meant");
  EXPECT_EQ(read(kHeader + "1,2,\"\x1b[2J\",4,5\n").error().message,
            "p.csv:2:5: \"?[2J\" is not a number");
}

TEST(Field, PointsBeyondAMillionRowsAreRefusedWhereTheyBegin) {
  std::string text = "x\n";
  for (int i = 0; i < 1'000'001; ++i) {
    text += "1\n";
  }
  EXPECT_EQ(CsvTable::parse(text, "p.csv").error().message,
            "p.csv:1000002:1: more than 1000000 rows: is this the file that you mean? Give it in "
            "parts");
}

// A file that is all hole: it takes no disk, and would take a gigabyte of memory.
TEST(Field, PointsThatAreTooLongAreNotReadIntoMemory) {
  const std::string file = ::testing::TempDir() + "field_points_too_long.csv";
  std::ofstream(file) << kHeader;
  std::filesystem::resize_file(file, std::uintmax_t{1} << 30U);
  rusage before{};
  getrusage(RUSAGE_SELF, &before);
  EXPECT_EQ(load_points_csv(file).error().message,
            file + ": longer than 64 MiB: is this the file that you mean? Give it in parts");
  rusage after{};
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 512 * 1024);  // KiB
  std::filesystem::remove(file);
}

TEST(Field, MorePointsThanAPersonWalksAreRefused) {
  const std::string file = ::testing::TempDir() + "field_points_too_many.csv";
  std::ofstream stream(file);
  stream << kHeader;
  for (int i = 0; i < 20'001; ++i) {
    stream << "1,2,3,4,5\n";
  }
  stream.close();
  EXPECT_EQ(load_points_csv(file).error().message,
            file + ": 20001 spots; at most 20000 are read: is this the survey?");
  std::filesystem::remove(file);
}

TEST(PointsCsv, ReportsAnUnreadableFile) {
  EXPECT_EQ(load_points_csv("/nowhere/p.csv").error().message, "/nowhere/p.csv: cannot be read");
  EXPECT_FALSE(load_points_csv("/tmp"));
}

}  // namespace
}  // namespace rayloc::points_csv_test
