// Names come from the network: no escape sequence of theirs may reach a terminal.
#pragma once

#include <string>

namespace rayloc::cli {

// Control characters replaced by '?'.
inline std::string printable(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      c = '?';
    }
  }
  return text;
}

}  // namespace rayloc::cli
