// Classic pcap, from the bytes of the file to the datagrams in it. The file begins with a magic
// number of the format, of the byte order and resolution that the input's first byte picks; pcapng
// has a target of its own.
#include <array>
#include <cstdint>

#include "tests/fuzz/pcap_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using Magic = std::array<std::uint8_t, 4>;
  constexpr std::array<Magic, 4> kMagics = {Magic{0xd4, 0xc3, 0xb2, 0xa1},
                                            Magic{0xa1, 0xb2, 0xc3, 0xd4},
                                            Magic{0x4d, 0x3c, 0xb2, 0xa1},
                                            Magic{0xa1, 0xb2, 0x3c, 0x4d}};
  const Magic& magic = kMagics[size == 0 ? 0 : data[0] % kMagics.size()];
  return rayloc::fuzz::parse_capture(magic, {data, size});
}
