// LocationMethod: how targets are located, of whatever kind they are.
#pragma once

#include <cstdint>
#include <string>

namespace rayloc {

enum class LocationMethod : std::uint8_t { kRayloc, kPaper };

// As messages and the command line have it.
inline std::string method_name(LocationMethod method) {
  return method == LocationMethod::kPaper ? "paper" : "rayloc";
}

}  // namespace rayloc
