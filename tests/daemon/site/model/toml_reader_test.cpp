#include "daemon/site/model/toml_reader.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::toml_reader_test {
namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;

std::string parse_error_of(std::string_view text) {
  const auto document = TomlDocument::parse(text, "x.toml");
  return document ? "" : document.error().message;
}

TEST(TomlDocument, ByteOrderMarkAndWindowsLineEndsChangeNothing) {
  const auto document = TomlDocument::parse(
      "\xef\xbb\xbf"
      "a = 1\r\n[t]\r\nb = 2\r\n",
      "x.toml");
  ASSERT_TRUE(document) << document.error().message;
  const TomlTable root = (*document)->root();
  EXPECT_EQ(root.integer("a", {}), 1);
  EXPECT_EQ(root.position("a").column, 5U);
  EXPECT_EQ(root.table("t")->integer("b", {}), 2);
  EXPECT_TRUE((*document)->finish());
}

TEST(TomlDocument, SyntaxErrorsHaveAPlace) {
  EXPECT_THAT(parse_error_of("a = 1\na = 2\n"), HasSubstr("x.toml:2:5: not TOML: "));
  EXPECT_THAT(parse_error_of("a = \"\xff\""), HasSubstr("x.toml:1:5: not TOML: "));
  EXPECT_THAT(parse_error_of("a = \"\n\""), HasSubstr("x.toml:1:"));
}

TEST(TomlDocument, DeepKeysAreRefusedBeforeTheParser) {
  std::string deep = "[x]\na";
  for (int i = 0; i < 200'000; ++i) {
    deep += ".a";
  }
  EXPECT_EQ(parse_error_of(deep + " = 1\n"),
            "x.toml:2:1: a key with more than 8 dots; no key of this file is nested that deep");
  EXPECT_THAT(parse_error_of("\"#\"" + deep.substr(5) + " = 1\n"), HasSubstr("x.toml:1:1: "));
}

TEST(TomlDocument, DotsOfNumbersTextAndCommentsAreNoKeys) {
  EXPECT_EQ(parse_error_of("# ......................\n"
                           "a = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]\n"
                           "b = \"..... \\\" ........\"\nc = '...........'\n"
                           "d = \"\"\"\n............\n\"\"\"\n"),
            "");
}

TEST(TomlDocument, RefusesDirectoriesMissingAndLargeFiles) {
  const fs::path folder = fs::path(::testing::TempDir()) / "toml_document_test";
  fs::create_directories(folder);
  const auto error_of = [](const fs::path& file) {
    const auto document = TomlDocument::read(file);
    return document ? "" : document.error().message;
  };
  EXPECT_THAT(error_of(folder), EndsWith("is a directory, not a file"));
  EXPECT_THAT(error_of(folder / "none.toml"),
              EndsWith("none.toml: cannot be opened: No such file or directory"));
  const fs::path large = folder / "large.toml";
  std::ofstream(large) << std::string((1U << 20U) + 1, '#');
  EXPECT_THAT(error_of(large), HasSubstr("large.toml: is larger than 1 MiB"));
  fs::remove_all(folder);
}

TEST(TomlDocument, ListsFiftyErrorsAndCountsTheRest) {
  std::string text;
  for (int i = 0; i < 60; ++i) {
    text += "key" + std::to_string(i) + " = 1\n";
  }
  const auto document = TomlDocument::parse(text, "x.toml");
  ASSERT_TRUE(document);
  (*document)->root().ask_for("other");
  EXPECT_THAT((*document)->finish().error().message, EndsWith("x.toml: and 10 more errors"));
}

TEST(TomlDocument, MessagesDoNotControlTheTerminal) {
  const auto document = TomlDocument::parse("\"\\u001b[2J\" = 1\n", "x.toml");
  ASSERT_TRUE(document);
  (*document)->root().ask_for("other");
  EXPECT_EQ((*document)->finish().error().message,
            "x.toml:1:1: unknown key '?[2J'; there are: other");
}

TEST(TomlTable, IntegersAreNumbersButNotTheReverse) {
  const auto document = TomlDocument::parse("a = 3\nb = 3.0\n", "x.toml");
  ASSERT_TRUE(document);
  const TomlTable root = (*document)->root();
  EXPECT_EQ(root.number("a", {}), 3.0);
  EXPECT_EQ(root.integer("b", {0, 9}), std::nullopt);
  EXPECT_EQ((*document)->finish().error().message,
            "x.toml:2:5: 'b' is a number; write a whole number without quotes, from 0 to 9");
}

TEST(TomlTable, OneValueIsAListOfOne) {
  const auto document =
      TomlDocument::parse("a = 1\nb = [2, 3.5]\nc = \"x\"\nd = [true, false]\n", "f.toml");
  ASSERT_TRUE(document);
  const TomlTable root = (*document)->root();
  EXPECT_EQ(root.numbers("a", {}), std::vector<double>{1.0});
  EXPECT_EQ(root.numbers("b", {}), (std::vector<double>{2.0, 3.5}));
  EXPECT_EQ(root.strings("c"), std::vector<std::string>{"x"});
  EXPECT_EQ(root.booleans("d"), (std::vector<bool>{true, false}));
  EXPECT_TRUE(root.numbers("absent", {}).empty());
  EXPECT_FALSE(root.is_array("a"));
  EXPECT_TRUE(root.is_array("b"));
  EXPECT_TRUE((*document)->finish());
}

TEST(TomlTable, EntriesOfListsAreRefusedAtTheirPlace) {
  const auto document =
      TomlDocument::parse("a = []\nb = [1, \"x\"]\nc = [1,\n 9]\nd = [1]\ne = [\"\"]\n", "f.toml");
  ASSERT_TRUE(document);
  const TomlTable root = (*document)->root();
  EXPECT_TRUE(root.numbers("a", {}).empty());
  EXPECT_TRUE(root.numbers("b", {}).empty());
  EXPECT_TRUE(root.numbers("c", {0.0, 5.0, "m"}).empty());
  EXPECT_TRUE(root.booleans("d").empty());
  EXPECT_TRUE(root.strings("e").empty());
  const std::string message = (*document)->finish().error().message;
  for (const char* part : {"f.toml:1:5: 'a' is an empty array",
                           "f.toml:2:9: 'b' is a string",
                           "f.toml:4:2: 'c' is 9; it must be from 0 to 5 m",
                           "f.toml:5:6: 'd' is an integer",
                           "f.toml:6:6: 'e' is empty"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST(TomlTable, PathsAreFromTheFoldersOfTheFile) {
  const auto document = TomlDocument::parse("a = \"b/c\"\nd = \"/e\"\n", "/home/x.toml");
  ASSERT_TRUE(document);
  EXPECT_EQ((*document)->root().path("a"), "/home/b/c");
  EXPECT_EQ((*document)->root().path("d"), "/e");
}

TEST(ToText, IsTheShortestThatReadsBack) {
  EXPECT_EQ(to_text(0.2), "0.2");
  EXPECT_EQ(to_text(5.19e9), "5190000000");
  EXPECT_EQ(to_text(-37.0), "-37");
  EXPECT_EQ(to_text(1e-7), "1e-07");
}

}  // namespace
}  // namespace rayloc::toml_reader_test
