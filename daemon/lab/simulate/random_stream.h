// Random numbers of a simulation: independent streams of one seed,
// identified by their purpose, so that one more draw of one kind
// leaves all others unchanged. A purpose has at most 16 letters.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string_view>

namespace rayloc {

using RandomStream = std::mt19937_64;

inline RandomStream random_stream(std::uint64_t seed,
                                  std::string_view purpose,
                                  std::uint64_t index = 0) {
  constexpr std::size_t kLongestPurpose = 16;
  std::array<std::seed_seq::result_type, 4 + kLongestPurpose> words{};
  std::size_t count = 0;
  for (const std::uint64_t value : {seed, index}) {
    words.at(count++) = static_cast<std::seed_seq::result_type>(value & 0xffffffffU);
    words.at(count++) = static_cast<std::seed_seq::result_type>(value >> 32U);
  }
  for (const char c : purpose) {
    words.at(count++) = static_cast<unsigned char>(c);
  }
  std::seed_seq sequence(words.begin(), words.end());
  return RandomStream(sequence);
}

}  // namespace rayloc
