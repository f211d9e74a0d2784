#include "capture/pcap_recorder.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr std::size_t kIpv4HeaderBytes = 20;
constexpr std::size_t kUdpHeaderBytes = 8;
constexpr std::size_t kMaxPayloadBytes = 65535 - kIpv4HeaderBytes - kUdpHeaderBytes;
constexpr std::uint8_t kProtocolUdp = 17;
constexpr std::chrono::seconds kSyncInterval{5};

// AXCSI.md 1.1: "NEXMON" sends to everybody.
constexpr std::array<std::uint8_t, 14> kEthernetHeader = {
    0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x4e, 0x45, 0x58, 0x4d, 0x4f, 0x4e, 0x08, 0x00};

// Appends integers to a buffer: little-endian for the file, big-endian for the packet.
class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}
  void little(std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      byte(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void big(std::uint64_t value, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) {
      byte(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void byte(std::uint8_t value) { out_.push_back(std::byte{value}); }

 private:
  std::vector<std::byte>& out_;
};

// RFC 1071, of an even number of bytes or the last ones.
std::uint32_t ones_sum(std::span<const std::byte> bytes, std::uint32_t sum) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto value = std::to_integer<std::uint32_t>(bytes[i]);
    sum += i % 2 == 0 ? value << 8 : value;
  }
  while (sum > 0xffff) {
    sum = (sum & 0xffff) + (sum >> 16);
  }
  return sum;
}

void put16(std::vector<std::byte>& out, std::size_t offset, std::uint32_t value) {
  out[offset] = static_cast<std::byte>(value >> 8);
  out[offset + 1] = static_cast<std::byte>(value & 0xff);
}

std::vector<std::byte> file_header() {
  std::vector<std::byte> header;
  Writer out(header);
  out.little(0xa1b2c3d4, 4);  // microseconds
  out.little(2, 2);
  out.little(4, 2);
  out.little(0, 8);  // time zone and accuracy: always 0
  out.little(262144, 4);
  out.little(1, 4);  // LINKTYPE_ETHERNET
  return header;
}

void append_ipv4(const Datagram& datagram, std::vector<std::byte>& out) {
  const std::size_t udp_bytes = kUdpHeaderBytes + datagram.payload.size();
  const std::size_t ip_at = out.size();
  const DatagramAddress& address = datagram.address;
  Writer writer(out);
  writer.byte(0x45);
  writer.byte(0);
  writer.big(kIpv4HeaderBytes + udp_bytes, 2);
  writer.big(0x00004000, 4);  // identification 0, don't fragment
  writer.byte(64);            // time to live
  writer.byte(kProtocolUdp);
  writer.big(0, 2);
  writer.big(address.source_ip, 4);
  writer.big(address.destination_ip, 4);
  const std::size_t udp_at = out.size();
  writer.big(address.source_port, 2);
  writer.big(address.destination_port, 2);
  writer.big(udp_bytes, 2);
  writer.big(0, 2);
  out.insert(out.end(), datagram.payload.begin(), datagram.payload.end());

  const std::span<const std::byte> all(out);
  const std::uint32_t ip_sum = ones_sum(all.subspan(ip_at, kIpv4HeaderBytes), 0);
  // RFC 768: over the addresses, the protocol, the length, and the datagram.
  const auto pseudo_header = static_cast<std::uint32_t>(kProtocolUdp + udp_bytes);
  const std::uint32_t udp_sum =
      ones_sum(all.subspan(udp_at), ones_sum(all.subspan(ip_at + 12, 8), pseudo_header));
  put16(out, ip_at + 10, ~ip_sum & 0xffff);
  // 0 would say that there is none.
  put16(out, udp_at + 6, udp_sum == 0xffff ? 0xffff : ~udp_sum & 0xffff);
}

// False when the time has no place in the file: classic pcap has 32 bits of seconds since 1970.
bool append_record(const Datagram& datagram, std::vector<std::byte>& out) {
  const auto time = std::chrono::floor<std::chrono::microseconds>(datagram.time);
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const std::int64_t s = seconds.time_since_epoch().count();
  if (s < 0 || s > std::numeric_limits<std::uint32_t>::max()) {
    return false;
  }
  const std::size_t length =
      kEthernetHeader.size() + kIpv4HeaderBytes + kUdpHeaderBytes + datagram.payload.size();
  Writer writer(out);
  writer.little(static_cast<std::uint64_t>(s), 4);
  writer.little(static_cast<std::uint64_t>((time - seconds).count()), 4);
  writer.little(length, 4);
  writer.little(length, 4);
  for (const std::uint8_t byte : kEthernetHeader) {
    writer.byte(byte);
  }
  append_ipv4(datagram, out);
  return true;
}

tl::unexpected<Error> cannot_write(const std::string& path, int error) {
  return make_error(ErrorKind::kUnavailable,
                    path + ": cannot be written: " + std::strerror(error) +
                        (error == ENOSPC || error == EFBIG ? "; make room on the disk" : ""));
}

}  // namespace

Expected<PcapRecorder> PcapRecorder::create(const std::string& path) {
  constexpr mode_t kMode = 0640;  // where somebody is, is nobody else's business
  const int fd = open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (fd < 0) {
    const bool exists = errno == EEXIST;
    return make_error(ErrorKind::kUnavailable,
                      path + ": cannot be recorded to: " + std::strerror(errno) +
                          (exists ? "; name a file that does not exist yet" : ""));
  }
  auto writer = AppendProcess::start(fd);
  const int error = writer ? writer->append(file_header()) : 0;
  if (!writer || error != 0) {
    unlink(path.c_str());
    close(fd);
    return writer ? cannot_write(path, error) : tl::make_unexpected(std::move(writer.error()));
  }
  PcapRecorder recorder(fd, path, std::move(*writer));
  recorder.counters_.bytes = file_header().size();
  return recorder;
}

PcapRecorder::PcapRecorder(int fd, std::string path, AppendProcess writer)
    : fd_(fd),
      path_(std::move(path)),
      writer_(std::move(writer)),
      synced_(std::chrono::steady_clock::now()) {}

PcapRecorder::PcapRecorder(PcapRecorder&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      path_(std::move(other.path_)),
      writer_(std::move(other.writer_)),
      records_(std::move(other.records_)),
      record_ends_(std::move(other.record_ends_)),
      synced_(other.synced_),
      counters_(other.counters_) {}

PcapRecorder::~PcapRecorder() {
  if (fd_ >= 0) {
    fdatasync(fd_);
    close(fd_);
  }
}

Expected<void> PcapRecorder::write(std::span<const Datagram> batch) {
  if (batch.empty()) {
    return {};
  }
  records_.clear();
  record_ends_.clear();
  Expected<void> result;
  for (const Datagram& datagram : batch) {
    RAYLOC_CHECK(datagram.payload.size() <= kMaxPayloadBytes);
    if (!append_record(datagram, records_)) {
      result = bad_input(path_ +
                         ": a datagram from before 1970 or after 2106 cannot be recorded;"
                         " set the clock of the machine that received it");
      break;
    }
    record_ends_.push_back(records_.size());
  }
  // Before the batch: an Error must mean that it is lost.
  if (result && std::chrono::steady_clock::now() - synced_ >= kSyncInterval) {
    result = sync();
  }
  if (result) {
    result = append_records();
  }
  counters_.given += batch.size();
  (result ? counters_.written : counters_.lost) += batch.size();
  counters_.errors += result ? 0U : 1U;
  return result;
}

// The end of the append that begins at `begin`: as many whole records as one may have. `record` is
// the first of them, and then the first of the next append.
std::size_t PcapRecorder::next_append(std::size_t begin, std::size_t& record) const {
  std::size_t end = record_ends_[record++];
  while (record < record_ends_.size() && record_ends_[record] - begin <= AppendProcess::kMaxBytes) {
    end = record_ends_[record++];
  }
  return end;
}

Expected<void> PcapRecorder::append_records() {
  const std::span<const std::byte> records(records_);
  std::size_t begin = 0;
  for (std::size_t record = 0; record < record_ends_.size();) {
    const std::size_t end = next_append(begin, record);
    const int error = writer_.append(records.subspan(begin, end - begin));
    if (error != 0) {
      // What of the batch is there goes again: lost is the whole of it.
      if (begin > 0 && ftruncate(fd_, static_cast<off_t>(counters_.bytes)) != 0) {
        return cannot_write(path_, errno);
      }
      return cannot_write(path_, error);
    }
    begin = end;
  }
  counters_.bytes += records_.size();
  return {};
}

Expected<void> PcapRecorder::sync() {
  synced_ = std::chrono::steady_clock::now();
  if (fdatasync(fd_) != 0 && errno != EINVAL) {  // EINVAL: a pipe or a device, say /dev/null
    return cannot_write(path_, errno);
  }
  return {};
}

}  // namespace rayloc
