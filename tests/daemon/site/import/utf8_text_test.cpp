// Text of other programs as UTF-8.
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "daemon/site/import/utf8_text.h"

namespace rayloc::utf8_text_test {
namespace {

std::string utf8(std::uint32_t code) {
  std::string text;
  append_utf8(code, text);
  return text;
}

TEST(Utf8Text, CharactersHaveOneToFourBytes) {
  EXPECT_EQ(utf8('A'), "A");
  EXPECT_EQ(utf8(0xfc), "\xc3\xbc");
  EXPECT_EQ(utf8(0x20ac), "\xe2\x82\xac");
  EXPECT_EQ(utf8(0x1f600), "\xf0\x9f\x98\x80");
  EXPECT_EQ(utf8(0xd800), "?");
  EXPECT_EQ(utf8(0x110000), "?");
}

TEST(Utf8Text, OtherBytesAreRecognised) {
  EXPECT_TRUE(is_utf8(""));
  EXPECT_TRUE(is_utf8("W\xc3\xa4nde \xe2\x82\xac \xf0\x9f\x98\x80"));
  for (const char* bytes :
       {"\xe0\xa0\x80", "\xed\x9f\xbf", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"}) {
    EXPECT_TRUE(is_utf8(bytes)) << "a bound of the characters of three and four bytes";
  }
  for (const char* bytes : {"W\xe4nde",
                            "W\xc3",
                            "\xe2\x82",
                            "\x80",
                            "\xc0\x80",
                            "\xff",
                            "\xc3\xc3",
                            "\xe0\x9f\xbf",
                            "\xed\xa0\x80",
                            "\xf0\x8f\xbf\xbf",
                            "\xf4\x90\x80\x80"}) {
    EXPECT_FALSE(is_utf8(bytes)) << bytes;
  }
}

TEST(Utf8Text, BytesOfWindowsAreLetters) {
  EXPECT_EQ(from_windows_1252("W\xc4NDE"), "WÄNDE");
  EXPECT_EQ(from_windows_1252("5 \x80"), "5 €");
  EXPECT_EQ(from_windows_1252("\x81"), "?");
}

TEST(Utf8Text, LettersWithAccentsHaveALowerCase) {
  EXPECT_EQ(lower_case("TÜREN Fenêtre"), "türen fenêtre");
  EXPECT_EQ(lower_case("ÀÞ"), "àþ");
  EXPECT_EQ(lower_case("×÷ß"), "×÷ß") << "these have no case";
  EXPECT_EQ(lower_case("ŠТ"), "ŠТ") << "other alphabets are kept";
}

}  // namespace
}  // namespace rayloc::utf8_text_test
