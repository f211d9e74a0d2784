#include "capture/decode/csi_words.h"

#include <array>
#include <bit>
#include <cstring>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// Branch-free integer arithmetic on a block of words that fits in the cache: the compiler
// vectorizes each loop, which a table of powers of two would prevent.
constexpr std::size_t kBlock = 64;
using Block = std::array<std::uint32_t, kBlock>;

constexpr int kFloatExponentBias = 127;
constexpr unsigned kFloatMantissaBits = 23;

// 2^exponent, the exponent being the `bits` low bits of `word` in two's complement.
template <unsigned bits>
float power_of_two(std::uint32_t word) {
  constexpr unsigned kShift = 32U - bits;
  const std::int32_t exponent = static_cast<std::int32_t>(word << kShift) >> kShift;
  const auto field = static_cast<std::uint32_t>(exponent + kFloatExponentBias);
  return std::bit_cast<float>(field << kFloatMantissaBits);
}

// The `bits` + 1 bits of `word` from `shift` on, as sign and magnitude.
template <unsigned bits>
float signed_magnitude(std::uint32_t word, unsigned shift) {
  constexpr std::uint32_t kMask = (1U << bits) - 1U;
  const auto magnitude = static_cast<std::int32_t>((word >> shift) & kMask);
  const std::int32_t minus = -static_cast<std::int32_t>((word >> (shift + bits)) & 1U);
  return static_cast<float>((magnitude ^ minus) - minus);
}

template <unsigned mantissa_bits, unsigned exponent_bits>
void unpack_float(const Block& words, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float scale = power_of_two<exponent_bits>(words[i]);
    out[2 * i] =
        scale * signed_magnitude<mantissa_bits>(words[i], exponent_bits + mantissa_bits + 1U);
    out[2 * i + 1] = scale * signed_magnitude<mantissa_bits>(words[i], exponent_bits);
  }
}

void unpack_int16(const Block& words, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    out[2 * i] = static_cast<float>(static_cast<std::int32_t>(words[i] << 16U) >> 16U);
    out[2 * i + 1] = static_cast<float>(static_cast<std::int32_t>(words[i]) >> 16U);
  }
}

void load_words(const std::byte* from, std::size_t count, Block& words) {
  std::memcpy(words.data(), from, count * kBytesPerWord);
  if constexpr (std::endian::native == std::endian::big) {
    for (std::uint32_t& word : words) {
      word = __builtin_bswap32(word);
    }
  }
}

}  // namespace

void unpack_csi_words(CsiWords layout,
                      std::span<const std::byte> words,
                      std::span<std::complex<float>> out) {
  RAYLOC_CHECK(words.size() == kBytesPerWord * out.size());
  Block block;  // filled by load_words before it is read
  for (std::size_t done = 0; done < out.size(); done += kBlock) {
    const std::size_t count = std::min(kBlock, out.size() - done);
    load_words(words.data() + kBytesPerWord * done, count, block);
    // [complex.numbers.general]: an array of complex<float> may be written as pairs of float.
    auto* pairs = reinterpret_cast<float*>(out.data() + done);
    switch (layout) {
      case CsiWords::kFloat12:
        unpack_float<11, 6>(block, count, pairs);
        break;
      case CsiWords::kFloat9:
        unpack_float<8, 5>(block, count, pairs);
        break;
      case CsiWords::kInt16:
        unpack_int16(block, count, pairs);
        break;
    }
  }
}

}  // namespace rayloc
