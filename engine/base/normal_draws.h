// NormalDraws: random numbers that follow from a key alone, so the result of a random step does not
// depend on threads, on other steps, or on the process that made earlier ones.
//
// Not for cryptography. Different objects may be used on different threads.
#pragma once

#include <cstdint>

namespace rayloc {

// A hash of 64 bits: one step of the generator splitmix64 (Steele, Lea, Flood 2014). Neighbouring
// numbers become unrelated.
std::uint64_t mixed(std::uint64_t value);

// The same key gives the same numbers, on any thread.
class NormalDraws {
 public:
  explicit NormalDraws(std::uint64_t key);

  // A standard normal number, one of a fixed table of 65,536 of them with mean 0 and variance 1.
  float normal() {
    index_ += kStep;
    return table_[index_ >> 16U];
  }
  std::uint32_t bits16();  // uniform in [0, 65536)
  double uniform();        // in (0, 1)

 private:
  // 2^32 over the golden ratio, odd: every entry is drawn equally often.
  static constexpr std::uint32_t kStep = 0x9e3779b1U;

  std::uint64_t next();

  const float* table_;
  std::uint32_t index_;  // of the table, in the upper 16 bits
  std::uint64_t state_;
  std::uint64_t bits_ = 0;  // of the last call of next() ...
  int parts_ = 0;           // ... with this many unused parts of 16
};

}  // namespace rayloc
