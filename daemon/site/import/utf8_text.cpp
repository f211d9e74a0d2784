#include "daemon/site/import/utf8_text.h"

#include <array>
#include <cstddef>

namespace rayloc {
namespace {

// Windows-1252 from 0x80 to 0x9f; 0: no character.
constexpr std::array<std::uint16_t, 32> kFrom0x80 = {
    0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017d, 0,      0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0,      0x017e, 0x0178};

// Number of bytes that follow the first one; 4 for a byte that begins no character.
std::size_t rest_of(unsigned char first) {
  if (first < 0x80U) {
    return 0;
  }
  if (first < 0xc2U || first > 0xf4U) {
    return 4;
  }
  return first < 0xe0U ? 1 : first < 0xf0U ? 2 : 3;
}

// False where three or four bytes write a shorter character, a surrogate or a code beyond Unicode.
bool is_second_byte(unsigned char first, unsigned char second) {
  switch (first) {
    case 0xe0U:
      return second >= 0xa0U;
    case 0xedU:
      return second < 0xa0U;
    case 0xf0U:
      return second >= 0x90U;
    case 0xf4U:
      return second < 0x90U;
    default:
      return true;
  }
}

}  // namespace

void append_utf8(std::uint32_t code, std::string& text) {
  const auto byte = [&](std::uint32_t bits) { text += static_cast<char>(bits); };
  const auto rest = [&](unsigned shift) { byte(0x80U | ((code >> shift) & 0x3fU)); };
  const bool is_surrogate = code >= 0xd800U && code < 0xe000U;
  if (is_surrogate || code > 0x10ffffU) {
    text += '?';
  } else if (code < 0x80U) {
    byte(code);
  } else if (code < 0x800U) {
    byte(0xc0U | (code >> 6U));
    rest(0);
  } else if (code < 0x10000U) {
    byte(0xe0U | (code >> 12U));
    rest(6);
    rest(0);
  } else {
    byte(0xf0U | (code >> 18U));
    rest(12);
    rest(6);
    rest(0);
  }
}

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t rest = rest_of(static_cast<unsigned char>(text[at]));
    if (rest > 3 || rest >= text.size() - at) {
      return false;
    }
    for (std::size_t i = 1; i <= rest; ++i) {
      if ((static_cast<unsigned char>(text[at + i]) & 0xc0U) != 0x80U) {
        return false;
      }
    }
    if (rest > 1 && !is_second_byte(static_cast<unsigned char>(text[at]),
                                    static_cast<unsigned char>(text[at + 1]))) {
      return false;
    }
    at += rest + 1;
  }
  return true;
}

std::string from_windows_1252(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) {
    const std::uint32_t byte = static_cast<unsigned char>(c);
    const bool is_special = byte >= 0x80U && byte < 0xa0U;
    const std::uint32_t code = is_special ? kFrom0x80.at(byte - 0x80U) : byte;
    append_utf8(code == 0 && is_special ? '?' : code, text);
  }
  return text;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (std::size_t i = 0; i < lower.size(); ++i) {
    const auto byte = static_cast<unsigned char>(lower[i]);
    const auto before = i > 0 ? static_cast<unsigned char>(lower[i - 1]) : 0U;
    const bool is_latin = before == 0xc3U && byte >= 0x80U && byte <= 0x9eU && byte != 0x97U;
    if ((byte >= 'A' && byte <= 'Z') || is_latin) {
      lower[i] = static_cast<char>(byte + 0x20U);
    }
  }
  return lower;
}

}  // namespace rayloc
