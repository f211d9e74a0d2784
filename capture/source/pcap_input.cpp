#include "capture/source/pcap_input.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/uio.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "capture/transport/poll_timeout.h"
#include "engine/base/check.h"

namespace rayloc::pcap {
namespace {

constexpr std::size_t kReadBytes = std::size_t{1} << 20;
constexpr std::size_t kPackedReadBytes = std::size_t{64} << 10;
constexpr std::byte kGzip0{0x1f};
constexpr std::byte kGzip1{0x8b};

// First bytes of a gzip member (deflated, the only method), and of captures.
constexpr std::string_view kMemberMagic = "\x1f\x8b\x08";
constexpr std::array<std::string_view, 5> kMagic = {
    "\xd4\xc3\xb2\xa1", "\xa1\xb2\xc3\xd4", "\x4d\x3c\xb2\xa1", "\xa1\xb2\x3c\x4d", "\n\r\r\n"};
// zlib's format number of "gzip only", with the largest window.
constexpr int kGzipWindow = 16 + MAX_WBITS;

std::string system_error(const std::string& name, const char* what) {
  return name + ": " + what + ": " + std::strerror(errno);
}

bool begins_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && !magic.empty() &&
         std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

enum class Begins { kMember, kCapture, kNothing, kUnknown };  // unknown: more bytes are needed

Begins what_begins(std::span<const std::byte> bytes) {
  if (begins_with(bytes, kMemberMagic)) {
    return Begins::kMember;
  }
  bool unknown = false;
  for (const std::string_view magic : kMagic) {
    if (begins_with(bytes, magic)) {
      return Begins::kCapture;
    }
    unknown = unknown ||
              (bytes.size() < magic.size() && begins_with(bytes, magic.substr(0, bytes.size())));
  }
  unknown = unknown || (bytes.size() < kMemberMagic.size() &&
                        begins_with(bytes, kMemberMagic.substr(0, bytes.size())));
  return unknown ? Begins::kUnknown : Begins::kNothing;
}

// Returns 1 if readable, 0 on time-out, or -1 with errno.
int wait_readable(int fd, Duration timeout) {
  pollfd waiting{.fd = fd, .events = POLLIN, .revents = 0};
  const int ready = poll(&waiting, 1, poll_milliseconds(timeout));
  return ready < 0 && errno == EINTR ? 0 : ready;
}

}  // namespace

// One gzip file: several members may follow one another.
class PcapInput::Inflater {
 public:
  Inflater() { RAYLOC_CHECK(inflateInit2(&stream_, kGzipWindow) == Z_OK); }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  struct Result {
    std::size_t consumed = 0;
    std::size_t produced = 0;
    bool member_ended = false;
    const char* error = nullptr;
  };
  Result run(std::span<const std::byte> in, std::span<std::byte> out) {
    // zlib reads through a pointer to non-const unless ZLIB_CONST is defined for all of it.
    stream_.next_in = static_cast<Bytef*>(const_cast<void*>(static_cast<const void*>(in.data())));
    stream_.avail_in = static_cast<uInt>(in.size());
    stream_.next_out = static_cast<Bytef*>(static_cast<void*>(out.data()));
    stream_.avail_out = static_cast<uInt>(out.size());
    const int status = inflate(&stream_, Z_NO_FLUSH);
    Result result;
    result.consumed = in.size() - stream_.avail_in;
    result.produced = out.size() - stream_.avail_out;
    if (status == Z_STREAM_END) {
      result.member_ended = true;
      inflateReset(&stream_);
    } else if (status != Z_OK && status != Z_BUF_ERROR) {
      result.error = stream_.msg != nullptr ? stream_.msg : "damaged data";
    }
    return result;
  }

 private:
  z_stream stream_{};
};

Expected<std::unique_ptr<PcapInput>> PcapInput::open(const std::string& path) {
  if (path == "-") {
    const int fd = dup(STDIN_FILENO);
    if (fd < 0) {
      return make_error(ErrorKind::kUnavailable, system_error("standard input", "cannot be read"));
    }
    return std::make_unique<PcapInput>(fd, "standard input");
  }
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) {
    return make_error(ErrorKind::kUnavailable, system_error(path, "cannot be opened"));
  }
  return std::make_unique<PcapInput>(fd, path);
}

PcapInput::PcapInput(int fd, std::string name) : fd_(fd), name_(std::move(name)) {}

PcapInput::~PcapInput() { close(fd_); }

void PcapInput::consume(std::size_t size) {
  RAYLOC_CHECK(size <= end_ - begin_);
  begin_ += size;
  offset_ += size;
}

// Makes room for `size` bytes after the window.
void PcapInput::make_room(std::size_t size) {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (buffer_.size() - end_ < size) {
    buffer_.resize(end_ + size);
  }
}

Expected<PcapInput::Fill> PcapInput::fill(Duration timeout) {
  if (damage_) {
    return tl::make_unexpected(*damage_);
  }
  if (unpacking_stopped_) {
    const std::vector<std::byte> packed = std::move(packed_);
    if (unpack(packed)) {
      return Fill::kMore;
    }
  }
  if (damage_) {
    return tl::make_unexpected(*damage_);
  }
  const int ready = wait_readable(fd_, timeout);
  if (ready < 0) {
    return make_error(ErrorKind::kUnavailable, system_error(name_, "cannot be read"));
  }
  return ready == 0 ? Fill::kTimeout : read_more();
}

Expected<PcapInput::Fill> PcapInput::read_more() {
  const bool direct = packing_ == Packing::kNone;
  const std::size_t size = direct ? kReadBytes : kPackedReadBytes;
  std::vector<std::byte> packed = direct ? std::vector<std::byte>() : packed_;
  const std::size_t kept = packed.size();  // possibly the beginning of a member
  packed.resize(direct ? 0 : kept + size);
  if (direct) {
    make_room(size);
  }
  const ssize_t got = ::read(fd_, direct ? buffer_.data() + end_ : packed.data() + kept, size);
  if (got < 0) {
    if (errno == EINTR || errno == EAGAIN) {
      return Fill::kTimeout;
    }
    return make_error(ErrorKind::kUnavailable, system_error(name_, "cannot be read"));
  }
  if (got == 0) {
    add_padding(kept);
    packed_.clear();
    return Fill::kEnd;
  }
  if (direct) {
    end_ += static_cast<std::size_t>(got);
    return Fill::kMore;
  }
  packed.resize(kept + static_cast<std::size_t>(got));
  if (packing_ == Packing::kUnknown) {
    // No capture begins with the first of gzip's two bytes, so one is enough.
    const bool gzip = packed[0] == kGzip0 && (packed.size() == 1 || packed[1] == kGzip1);
    packing_ = gzip ? Packing::kGzip : Packing::kNone;
    inflater_ = std::make_unique<Inflater>();
  }
  if (packing_ == Packing::kGzip) {
    return unpack(packed) || !damage_ ? Expected<Fill>(Fill::kMore) : tl::make_unexpected(*damage_);
  }
  take_plain(packed);
  return Fill::kMore;
}

void PcapInput::take_plain(std::span<const std::byte> bytes) {
  make_room(bytes.size());
  std::copy(bytes.begin(), bytes.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
  end_ += bytes.size();
}

void PcapInput::add_padding(std::size_t bytes) {
  padding_.offset = padding_.bytes == 0 ? packed_offset_ : padding_.offset;
  padding_.bytes += bytes;
  packed_offset_ += bytes;
}

// After a member: skips bytes that are neither another member nor the beginning of one. Returns
// their number in `packed`.
std::size_t PcapInput::skip_padding(std::span<const std::byte> packed) {
  std::size_t zeros = 0;
  while (part_ == Part::kBetween && zeros < packed.size() && packed[zeros] == std::byte{0}) {
    ++zeros;
  }
  const std::span<const std::byte> rest = packed.subspan(zeros);
  const Begins next = part_ == Part::kGarbage ? Begins::kNothing : what_begins(rest);
  if (rest.empty() || next == Begins::kUnknown || next == Begins::kMember) {
    part_ = next == Begins::kMember ? Part::kMember : part_;
    add_padding(zeros);
    return zeros;
  }
  if (next == Begins::kCapture) {
    packing_ = Packing::kNone;
    add_padding(zeros);
    take_plain(rest);
    return packed.size();
  }
  part_ = Part::kGarbage;
  add_padding(packed.size());
  return packed.size();
}

// Returns true if the window grew. Damage after good data is kept for the next fill().
bool PcapInput::unpack(std::span<const std::byte> packed) {
  make_room(kReadBytes);
  const std::size_t before = end_;
  std::size_t at = 0;
  bool goes_on = true;
  while (goes_on && !damage_ && end_ < buffer_.size()) {
    if (part_ != Part::kMember) {
      at += skip_padding(packed.subspan(at));
      goes_on = part_ == Part::kMember;
      continue;
    }
    const Inflater::Result result =
        inflater_->run(packed.subspan(at), std::span(buffer_).subspan(end_));
    at += result.consumed;
    end_ += result.produced;
    packed_offset_ += result.consumed;
    goes_on = result.consumed + result.produced > 0;
    if (goes_on) {
      inside_gzip_ = !result.member_ended;
    }
    part_ = result.member_ended ? Part::kBetween : Part::kMember;
    if (result.error != nullptr) {
      damage_ = Error{ErrorKind::kBadInput,
                      name_ + ": byte " + std::to_string(packed_offset_) +
                          " of the gzip'd file: " + result.error};
    }
  }
  packed_.assign(packed.begin() + static_cast<std::ptrdiff_t>(at), packed.end());
  // The output is full: zlib may hold back output of the input it has consumed.
  unpacking_stopped_ = end_ == buffer_.size();
  return end_ > before;
}

}  // namespace rayloc::pcap
