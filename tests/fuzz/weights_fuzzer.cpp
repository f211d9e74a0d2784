// Weights of a network: any bytes are refused with the file's name, or are finite numbers that give
// the same bytes again.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "daemon/site/model/weights_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto weights = rayloc::parse_weights(bytes, "/nonexistent/cifi.f32");
  if (!weights) {
    if (weights.error().message.rfind("/nonexistent/cifi.f32: ", 0) != 0) {
      std::abort();
    }
    return 0;
  }
  for (const float weight : *weights) {
    if (!std::isfinite(weight)) {
      std::abort();
    }
  }
  if (rayloc::weights_bytes(*weights) != bytes) {
    std::abort();
  }
  return 0;
}
