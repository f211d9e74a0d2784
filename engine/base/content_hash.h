// ContentHash: a 64-bit FNV-1a hash to distinguish scenes, calibrations, caches and their inputs.
//
// It protects against mistakes, not against forgery.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/vec3.h"

namespace rayloc {

class ContentHash {
 public:
  void add(std::string_view bytes) {
    add(static_cast<std::uint64_t>(bytes.size()));  // distinguishes "ab", "c" from "a", "bc"
    for (const char c : bytes) {
      mix(static_cast<unsigned char>(c));
    }
  }
  void add(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) {
      mix(static_cast<unsigned char>(value >> static_cast<unsigned>(shift)));
    }
  }
  void add(const Vec3d& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }

  std::uint64_t value() const { return state_; }

  // The hash in 16 hexadecimal digits.
  std::string text() const {
    // Base 16, as content hashes are usually written.
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (int shift = 60; shift >= 0; shift -= 4) {
      text += kDigits[(state_ >> static_cast<unsigned>(shift)) & 15U];
    }
    return text;
  }

 private:
  void mix(unsigned char byte) { state_ = (state_ ^ byte) * 0x100000001b3ULL; }

  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

}  // namespace rayloc
