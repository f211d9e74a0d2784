#include "capture/decode/axcsi_decoder.h"
#include "tests/fuzz/decoder_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayloc::AxcsiDecoder kDecoder;
  rayloc::fuzz::check_decoder(kDecoder, {data, size});
  return 0;
}
