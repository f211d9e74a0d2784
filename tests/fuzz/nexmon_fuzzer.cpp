#include "capture/decode/nexmon_decoder.h"
#include "tests/fuzz/decoder_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayloc::NexmonDecoder kVersion1(rayloc::NexmonVersion::kV1);
  static const rayloc::NexmonDecoder kVersion2(rayloc::NexmonVersion::kV2);
  rayloc::fuzz::check_decoder(kVersion1, {data, size});
  rayloc::fuzz::check_decoder(kVersion2, {data, size});
  return 0;
}
