// The encodings of characters in a string of a STEP file (ISO 10303-21, 6.4.3).
#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/site/import/ifc/step_text.h"
#include "daemon/site/import/utf8_text.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

// The number that `digits` are in hexadecimal; 0xffffffff if they are no number.
std::uint32_t code_of(std::string_view digits) {
  std::uint32_t code = 0;
  const char* const end = digits.data() + digits.size();
  const auto read = std::from_chars(digits.data(), end, code, 16);
  return read.ec == std::errc() && read.ptr == end ? code : 0xffffffffU;
}

// Codes of 4 or 8 digits, up to \X0\. In UTF-16 two of them may be one character.
void append_codes(std::string_view codes, std::size_t digits, std::string& text) {
  std::uint32_t high = 0;
  for (std::size_t at = 0; at + digits <= codes.size(); at += digits) {
    const std::uint32_t code = code_of(codes.substr(at, digits));
    if (code >= 0xd800U && code < 0xdc00U && high == 0) {
      high = code;
      continue;
    }
    const bool is_pair = high != 0 && code >= 0xdc00U && code < 0xe000U;
    append_utf8(is_pair ? 0x10000U + ((high - 0xd800U) << 10U) + (code - 0xdc00U) : code, text);
    high = 0;
  }
}

// Appends what the directive at the begin of `rest`, a backslash, means; returns its length.
std::size_t append_directive(std::string_view rest, std::string& text) {
  constexpr std::string_view kEnd = "\\X0\\";
  for (const auto& [begin, digits] : {std::pair{std::string_view("\\X2\\"), std::size_t{4}},
                                      {std::string_view("\\X4\\"), std::size_t{8}}}) {
    if (rest.starts_with(begin)) {
      const std::size_t end = std::min(rest.find(kEnd, begin.size()), rest.size());
      append_codes(rest.substr(begin.size(), end - begin.size()), digits, text);
      return std::min(end + kEnd.size(), rest.size());
    }
  }
  if (rest.starts_with("\\X\\") && rest.size() >= 5) {
    append_utf8(code_of(rest.substr(3, 2)), text);
    return 5;
  }
  if (rest.starts_with("\\S\\") && rest.size() >= 4) {
    append_utf8(0x80U + (static_cast<unsigned char>(rest[3]) & 0x7fU), text);
    return 4;
  }
  if (rest.size() >= 4 && rest[1] == 'P' && rest[3] == '\\') {
    return 4;  // another alphabet for \S\, which is read as the first
  }
  text += rest.starts_with("\\N\\") ? ' ' : '\\';
  return rest.starts_with("\\N\\") ? 3 : rest.starts_with("\\\\") ? 2 : 1;
}

}  // namespace

std::string step_string(std::string_view value) {
  std::string text;
  if (value.size() < 2 || value.front() != '\'' || value.back() != '\'') {
    return text;
  }
  const std::string_view inner = value.substr(1, value.size() - 2);
  for (std::size_t at = 0; at < inner.size();) {
    if (inner[at] == '\\') {
      at += append_directive(inner.substr(at), text);
      continue;
    }
    text += inner[at];
    at += inner.substr(at, 2) == "''" ? std::size_t{2} : std::size_t{1};
  }
  return printable(std::move(text));
}

}  // namespace rayloc
