// Makes external text (files, the network) safe for a terminal or a log: no escape sequence reaches
// the terminal, no line break the log.
#pragma once

#include <cstddef>
#include <string>

namespace rayloc {

// Control characters replaced by '?', those of UTF-8 (U+0080 to U+009F) as well. `keep`: one that
// is kept, such as the line ends of a message of several lines.
inline std::string printable(std::string text, char keep = '\0') {
  std::size_t size = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const unsigned char next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1])
                                                   : static_cast<unsigned char>(0);
    if (c == 0xc2 && next >= 0x80 && next < 0xa0) {
      text[size++] = '?';
      ++i;
    } else {
      const bool control = c < 0x20 || c == 0x7f;
      text[size++] = control && (keep == '\0' || text[i] != keep) ? '?' : text[i];
    }
  }
  text.resize(size);
  return text;
}

}  // namespace rayloc
