#include "daemon/base/roff.h"

namespace rayloc {

std::string roff(std::string_view line) {
  std::string result;
  for (const char c : line) {
    if (c == '\\') {
      result += "\\e";
      continue;
    }
    result += c == '-' ? "\\-" : std::string(1, c);
  }
  return !result.empty() && (result[0] == '.' || result[0] == '\'') ? "\\&" + result : result;
}

}  // namespace rayloc
