// pcapng, from the bytes of the file to the datagrams in it. The file begins with a section header
// for any input; classic pcap has a target of its own.
#include <array>
#include <cstdint>

#include "tests/fuzz/pcap_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<std::uint8_t, 4> kMagic = {0x0a, 0x0d, 0x0d, 0x0a};
  return rayloc::fuzz::parse_capture(kMagic, {data, size});
}
