// Writes the seeds of the decoders', the assembler's and the relay's fuzz targets: a few datagrams
// of each format and chip, as the extractors send them.
//
//   make_corpus tests/fuzz/corpus
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/wire_writer.h"

namespace rayloc {
namespace {

using test::NexmonChip;
using test::Recording;
using test::WireFrame;
using test::WirePhy;

using Bytes = std::vector<std::byte>;

constexpr std::size_t kCut = 40;  // bytes of a datagram that ends within its header

void put(Bytes& bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
  }
}

void append(Bytes& to, const Bytes& from) { to.insert(to.end(), from.begin(), from.end()); }

class Corpus {
 public:
  explicit Corpus(std::string folder) : folder_(std::move(folder)) {}

  void write(const std::string& target, const std::string& name, const Bytes& bytes) const {
    std::filesystem::create_directories(folder_ + "/" + target);
    std::ofstream out(folder_ + "/" + target + "/" + name, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) {
      std::fprintf(
          stderr, "%s/%s/%s: cannot be written\n", folder_.c_str(), target.c_str(), name.c_str());
      std::exit(1);
    }
  }

  void write_recording(const std::string& target,
                       const std::string& name,
                       const Recording& recording) const {
    Bytes first = recording.front().payload;
    write(target, name, first);
    first.resize(kCut);
    write(target, name + "_cut", first);
    Recording reordered(recording.begin(),
                        recording.begin() + static_cast<std::ptrdiff_t>(
                                                std::min<std::size_t>(4, recording.size())));
    std::reverse(reordered.begin(), reordered.end());
    reordered.push_back(recording.front());  // and one twice
    write_assembled(name, std::byte{0x20}, recording);
    write_assembled(name + "_reordered", std::byte{0x03}, reordered);
  }

 private:
  // As assembler_fuzzer.cpp reads it.
  void write_assembled(const std::string& name,
                       std::byte options,
                       const Recording& recording) const {
    Bytes bytes = {options};
    for (const auto& datagram : recording) {
      put(bytes, 1, 2);  // a millisecond later
      put(bytes, datagram.payload.size(), 2);
      append(bytes, datagram.payload);
    }
    write("assembler", name, bytes);
  }

  std::string folder_;
};

WireFrame frame_of(WirePhy phy, int channel_mhz, int occupied_mhz, int centre_tone, int streams) {
  WireFrame frame;
  frame.phy = phy;
  frame.channel_mhz = channel_mhz;
  frame.occupied_mhz = occupied_mhz;
  frame.centre_tone = centre_tone;
  frame.streams = frame.transmitted_streams = streams;
  frame.channel = test::delayed_path(93e-9, phy == WirePhy::kHe ? 78'125.0 : 312'500.0);
  return frame;
}

// Two frames, the second a retry by its sequence control.
template <typename Write>
Recording twice(WireFrame frame, const Write& write) {
  Recording recording = write(frame);
  ++frame.sequence;
  for (auto& datagram : write(frame)) {
    recording.push_back(std::move(datagram));
  }
  return recording;
}

void write_decoders(const Corpus& corpus) {
  const auto axcsi = [](const WireFrame& frame) { return test::write_axcsi(frame, {}); };
  corpus.write_recording("axcsi", "vht40", twice(frame_of(WirePhy::kVht, 40, 40, 0, 1), axcsi));
  corpus.write_recording(
      "axcsi", "vht80_two_streams", twice(frame_of(WirePhy::kVht, 80, 80, 0, 2), axcsi));
  corpus.write_recording(
      "axcsi", "legacy20_in_80", twice(frame_of(WirePhy::kLegacy, 80, 20, 96, 1), axcsi));
  const Recording he40 = axcsi(frame_of(WirePhy::kHe, 40, 40, 0, 1));
  corpus.write("axcsi", "he40_from_0", he40[0].payload);
  corpus.write("axcsi", "he40_from_256", he40[1].payload);

  WireFrame wide = frame_of(WirePhy::kVht, 80, 80, 0, 1);
  wide.rx_chains = {0, 1};
  for (const auto& [chip, name] : {std::pair(NexmonChip::k4339, "4339"),
                                   std::pair(NexmonChip::k4358, "4358"),
                                   std::pair(NexmonChip::k43455c0, "43455c0"),
                                   std::pair(NexmonChip::k4366c0, "4366c0")}) {
    for (const int version : {1, 2}) {
      corpus.write_recording("nexmon",
                             std::string(name) + "_v" + std::to_string(version),
                             test::write_nexmon(wide, chip, version, {}));
    }
  }
  corpus.write_recording(
      "ubilocate", "vht40", test::write_ubilocate(frame_of(WirePhy::kVht, 40, 40, 0, 4), {}));
}

constexpr std::uint64_t kNow = 1'800'000'000'000'000'000;     // of 2027 [ns]
constexpr std::uint64_t kOf2200 = 7'258'118'400'000'000'000;  // the last accepted time [ns]

// A header as capture/transport/relayed_datagram.h has it, and what follows it.
Bytes relayed(std::uint64_t kind,
              std::uint64_t time,
              const Bytes& payload = {},
              const std::string& magic = "RLC1") {
  Bytes bytes;
  for (const char letter : magic) {
    bytes.push_back(static_cast<std::byte>(letter));
  }
  put(bytes, kind, 4);
  for (const std::uint64_t value : {std::uint64_t{7}, std::uint64_t{41}, time, time - 10}) {
    put(bytes, value, 8);
  }
  put(bytes, 3, 8);
  put(bytes, 2, 8);
  put(bytes, 0x0a0a0a02, 4);
  put(bytes, 0x0a0a0a01, 4);
  put(bytes, 5500, 2);
  put(bytes, 5501, 2);
  append(bytes, payload);
  return bytes;
}

void write_relay(const Corpus& corpus) {
  corpus.write("relay", "datagram", relayed(0, kNow, test::write_axcsi({}, {}).front().payload));
  corpus.write("relay", "tick", relayed(1, kNow));
  corpus.write("relay", "other_kind", relayed(2, kNow));
  corpus.write("relay", "other_magic", relayed(0, kNow, {}, "RLC2"));
  Bytes cut = relayed(0, kNow);
  cut.pop_back();
  corpus.write("relay", "cut", cut);
  corpus.write("relay", "of_2200", relayed(1, kOf2200));
  corpus.write("relay", "after_2200", relayed(1, kOf2200 + 11));
}

}  // namespace
}  // namespace rayloc

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_corpus FOLDER\n", stderr);
    return 64;
  }
  const rayloc::Corpus corpus(argv[1]);
  rayloc::write_decoders(corpus);
  rayloc::write_relay(corpus);
}
