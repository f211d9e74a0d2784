#include "tests/bench/mapped_datagrams.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace rayloc::bench {
namespace {

constexpr std::size_t kSequenceOffset = 6;  // of an AX-CSI datagram

std::uint16_t sequence_of(const test::RecordedDatagram& datagram) {
  std::uint16_t sequence = 0;
  std::memcpy(&sequence, datagram.payload.data() + kSequenceOffset, sizeof(sequence));
  return sequence;
}

}  // namespace

MappedDatagrams::MappedDatagrams(test::Recording recording, std::size_t at_least) {
  const auto frames =
      static_cast<unsigned>(sequence_of(recording.back()) - sequence_of(recording.front()) + 1);
  const Duration span =
      recording.back().time - recording.front().time + std::chrono::milliseconds(50);
  std::FILE* file = std::tmpfile();  // already unlinked
  if (file == nullptr) {
    throw std::runtime_error("no temporary file");
  }
  std::vector<std::size_t> sizes;
  while (datagrams_.size() < at_least) {
    for (test::RecordedDatagram& datagram : recording) {
      std::fwrite(datagram.payload.data(), 1, datagram.payload.size(), file);
      datagrams_.push_back({datagram.time, {}, {}});
      sizes.push_back(datagram.payload.size());
      size_ += datagram.payload.size();
      datagram.time += span;
      const auto next = static_cast<std::uint16_t>(sequence_of(datagram) + frames);
      std::memcpy(datagram.payload.data() + kSequenceOffset, &next, sizeof(next));
    }
  }
  const bool written = std::fflush(file) == 0;
  map_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, fileno(file), 0);
  std::fclose(file);
  if (!written || map_ == MAP_FAILED) {
    throw std::runtime_error("the temporary file cannot be written or mapped");
  }
  std::size_t offset = 0;
  for (std::size_t i = 0; i < datagrams_.size(); ++i) {
    datagrams_[i].payload = {static_cast<const std::byte*>(map_) + offset, sizes[i]};
    offset += sizes[i];
  }
}

MappedDatagrams::~MappedDatagrams() { munmap(map_, size_); }

}  // namespace rayloc::bench
