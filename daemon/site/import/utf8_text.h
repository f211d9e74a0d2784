// Text of other programs as UTF-8.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rayloc {

// Appends a character; '?' for a surrogate and for a code beyond Unicode.
void append_utf8(std::uint32_t code, std::string& text);

// False for bytes that are not UTF-8, as programs of the 1990s write letters with accents.
bool is_utf8(std::string_view text);

// Bytes of Windows-1252, the usual encoding of these programs in Western Europe and America.
std::string from_windows_1252(std::string_view bytes);

// Lower case of A to Z and of the letters with accents of Western Europe (U+00C0 to U+00DE);
// others are kept.
std::string lower_case(std::string_view text);

}  // namespace rayloc
