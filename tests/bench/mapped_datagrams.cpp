#include "tests/bench/mapped_datagrams.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace rayloc::bench {
namespace {

constexpr std::size_t kFileHeader = 24;
constexpr std::size_t kRecordHeader = 16;
constexpr std::size_t kPacketHeaders = 14 + 20 + 8;
constexpr std::size_t kSequenceOffset = 6;

struct Payload {
  Timestamp time;
  std::vector<char> bytes;
};

std::vector<Payload> read_payloads(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> file((std::istreambuf_iterator<char>(in)), {});
  const auto u32 = [&file](std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, file.data() + offset, sizeof(value));
    return value;
  };
  std::vector<Payload> payloads;
  for (std::size_t at = kFileHeader; at + kRecordHeader <= file.size();) {
    const std::size_t length = u32(at + 8);
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(at + kRecordHeader);
    Payload payload;
    payload.time =
        Timestamp(std::chrono::seconds(u32(at)) + std::chrono::microseconds(u32(at + 4)));
    payload.bytes.assign(begin + kPacketHeaders, begin + static_cast<std::ptrdiff_t>(length));
    payloads.push_back(std::move(payload));
    at += kRecordHeader + length;
  }
  if (payloads.empty()) {
    throw std::runtime_error(path + ": no datagrams");
  }
  return payloads;
}

std::uint16_t sequence_of(const Payload& payload) {
  std::uint16_t sequence = 0;
  std::memcpy(&sequence, payload.bytes.data() + kSequenceOffset, sizeof(sequence));
  return sequence;
}

}  // namespace

MappedDatagrams::MappedDatagrams(const std::string& capture, std::size_t at_least) {
  std::vector<Payload> payloads =
      read_payloads(std::string(RAYLOC_TEST_DATA) + "/captures/" + capture);
  const auto frames =
      static_cast<unsigned>(sequence_of(payloads.back()) - sequence_of(payloads.front()) + 1);
  const Duration span =
      payloads.back().time - payloads.front().time + std::chrono::milliseconds(50);
  std::FILE* file = std::tmpfile();  // already unlinked
  if (file == nullptr) {
    throw std::runtime_error("no temporary file");
  }
  std::vector<std::size_t> sizes;
  while (datagrams_.size() < at_least) {
    for (Payload& payload : payloads) {
      std::fwrite(payload.bytes.data(), 1, payload.bytes.size(), file);
      datagrams_.push_back({payload.time, {}, {}});
      sizes.push_back(payload.bytes.size());
      size_ += payload.bytes.size();
      payload.time += span;
      const auto next = static_cast<std::uint16_t>(sequence_of(payload) + frames);
      std::memcpy(payload.bytes.data() + kSequenceOffset, &next, sizeof(next));
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
