#include "capture/decode/intel5300_decoder.h"
#include "tests/fuzz/decoder_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayloc::Intel5300Decoder kDecoder;
  rayloc::fuzz::check_decoder(kDecoder, {data, size});
  return 0;
}
