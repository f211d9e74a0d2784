#include "daemon/site/model/weights_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "engine/base/content_hash.h"

namespace rayloc {
namespace {

constexpr std::string_view kWeightsMagic = "RLNW";
constexpr std::uint32_t kWeightsFormat = 1;
constexpr std::size_t kWord = 4;  // bytes
constexpr std::size_t kWeightsHeader = 3 * kWord;

void append_word(std::string& bytes, std::uint32_t word) {
  for (unsigned shift = 0; shift < 32; shift += 8) {
    bytes += static_cast<char>(static_cast<unsigned char>(word >> shift));
  }
}

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < kWord; ++i) {
    word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  }
  return word;
}

}  // namespace

std::string weights_bytes(std::span<const float> weights) {
  std::string bytes(kWeightsMagic);
  append_word(bytes, kWeightsFormat);
  append_word(bytes, static_cast<std::uint32_t>(weights.size()));
  for (const float weight : weights) {
    append_word(bytes, std::bit_cast<std::uint32_t>(weight));
  }
  return bytes;
}

std::string weights_hash(std::string_view bytes) {
  ContentHash hash;
  hash.add(bytes);
  return hash.text();
}

Expected<std::vector<float>> parse_weights(std::string_view bytes,
                                           const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() + ": " + why + ": train again (rayloc train)");
  };
  if (bytes.size() < kWeightsHeader || bytes.substr(0, kWeightsMagic.size()) != kWeightsMagic) {
    return refuse("no file of weights");
  }
  if (const std::uint32_t format = word_at(bytes, kWord); format != kWeightsFormat) {
    return refuse("format " + std::to_string(format) + " is not known; this program reads " +
                  std::to_string(kWeightsFormat));
  }
  const std::size_t count = word_at(bytes, 2 * kWord);
  if (bytes.size() - kWeightsHeader != count * kWord) {
    return refuse("states " + std::to_string(count) + " weights and has bytes for " +
                  std::to_string((bytes.size() - kWeightsHeader) / kWord));
  }
  std::vector<float> weights(count);
  for (std::size_t i = 0; i < count; ++i) {
    weights[i] = std::bit_cast<float>(word_at(bytes, kWeightsHeader + i * kWord));
  }
  if (!std::all_of(weights.begin(), weights.end(), [](float w) { return std::isfinite(w); })) {
    return refuse("a weight is not finite");
  }
  return weights;
}

}  // namespace rayloc
