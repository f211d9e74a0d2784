// Weights of a network as a file: "RLNW", the format (1) and the number of weights as 32-bit words,
// then the weights as 32-bit floats, all little-endian.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

std::string weights_bytes(std::span<const float> weights);
// Hash of these bytes, in 16 hexadecimal digits.
std::string weights_hash(std::string_view bytes);

// `file`: for messages. An Error (kConfiguration) for a file that is truncated, longer, of another
// format or has a number that is not finite.
Expected<std::vector<float>> parse_weights(std::string_view bytes,
                                           const std::filesystem::path& file);

}  // namespace rayloc
