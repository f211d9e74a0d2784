// PcapInput: the bytes of a capture file, a pipe or standard input, decompressed if gzip'd, in one
// window that grows at its end and is consumed at its beginning.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc::pcap {

class PcapInput {
 public:
  // `path` "-" is standard input. kUnavailable when it cannot be opened.
  static Expected<std::unique_ptr<PcapInput>> open(const std::string& path);
  // Takes over the descriptor.
  PcapInput(int fd, std::string name);
  ~PcapInput();
  PcapInput(const PcapInput&) = delete;
  PcapInput& operator=(const PcapInput&) = delete;

  // Bytes that have been read and not consumed. Invalidated by fill().
  std::span<const std::byte> window() const {
    return std::span<const std::byte>(buffer_).subspan(begin_, end_ - begin_);
  }
  void consume(std::size_t size);

  enum class Fill { kMore, kTimeout, kEnd };
  // Waits up to `timeout` for more bytes at the end of the window.
  Expected<Fill> fill(Duration timeout);

  // Offset of the window's beginning, in bytes of the unpacked file.
  std::uint64_t offset() const { return offset_; }
  // The gzip'd file ended inside its compressed data.
  bool ends_within_gzip() const { return inside_gzip_; }
  const std::string& name() const { return name_; }

  // Bytes after the members of a gzip'd file that are no member: zeros, or other appended data.
  struct Padding {
    std::uint64_t offset = 0;  // offset of the first one, in the packed file
    std::uint64_t bytes = 0;
  };
  const Padding& padding() const { return padding_; }

 private:
  class Inflater;

  Expected<Fill> read_more();
  bool unpack(std::span<const std::byte> packed);
  std::size_t skip_padding(std::span<const std::byte> packed);
  void add_padding(std::size_t bytes);
  void take_plain(std::span<const std::byte> bytes);
  void make_room(std::size_t size);

  int fd_;
  std::string name_;
  std::vector<std::byte> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t offset_ = 0;

  enum class Packing { kUnknown, kNone, kGzip };
  // The next part of a gzip'd file.
  enum class Part { kMember, kBetween, kGarbage };
  Packing packing_ = Packing::kUnknown;
  std::vector<std::byte> packed_;  // read from the file and not yet unpacked
  std::uint64_t packed_offset_ = 0;
  bool unpacking_stopped_ = false;
  std::optional<Error> damage_;
  std::unique_ptr<Inflater> inflater_;
  Part part_ = Part::kMember;
  Padding padding_;
  bool inside_gzip_ = false;
};

}  // namespace rayloc::pcap
