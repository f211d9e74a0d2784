#include "capture/transport/relay_sender.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <random>
#include <utility>

namespace rayloc {
namespace {

constexpr timeval kPatience{.tv_sec = 0, .tv_usec = 100'000};
// The kernel grants what net.core.wmem_max allows.
constexpr int kSendBufferBytes = 8 << 20;

std::uint64_t draw_epoch() {
  std::random_device device;
  return std::uint64_t{device()} << 32U | device();
}

}  // namespace

Expected<std::unique_ptr<RelaySender>> RelaySender::open(const std::string& path) {
  if (path.empty() || path.size() >= sizeof(sockaddr_un::sun_path)) {
    return make_error(ErrorKind::kUsage,
                      "'" + path + "': write the path of a socket, at most " +
                          std::to_string(sizeof(sockaddr_un::sun_path) - 1) + " characters");
  }
  return std::unique_ptr<RelaySender>(new RelaySender(path));
}

RelaySender::RelaySender(std::string path) : path_(std::move(path)), epoch_(draw_epoch()) {}

RelaySender::~RelaySender() { disconnect(); }

void RelaySender::disconnect() {
  if (fd_ >= 0) {
    close(fd_);
    fd_ = -1;
  }
}

bool RelaySender::connect() {
  if (fd_ >= 0) {
    return true;
  }
  fd_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path_.begin(), path_.end(), &address.sun_path[0]);
  if (fd_ < 0 || ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    disconnect();
    return false;
  }
  setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &kPatience, sizeof kPatience);
  setsockopt(fd_, SOL_SOCKET, SO_SNDBUF, &kSendBufferBytes, sizeof kSendBufferBytes);
  stalled_ = false;
  return true;
}

void RelaySender::note_source(const SourceCounters& source) {
  kernel_drops_ = source.kernel_drops;
  rejected_ = 0;
  for (const auto& [reason, count] : source.rejected) {
    rejected_ += count;
  }
}

Expected<void> RelaySender::write(const DatagramBatch& batch) {
  connect();
  RelayHeader header;
  header.epoch = epoch_;
  header.kernel_drops = kernel_drops_;
  header.rejected = rejected_;
  for (std::size_t i = 0; i < batch.datagrams.size(); ++i) {
    const Datagram& datagram = batch.datagrams[i];
    // The watermark of the batch is valid after its last datagram.
    header.watermark =
        i + 1 < batch.datagrams.size() ? watermark_ : std::max(watermark_, batch.watermark);
    header.time = datagram.time;
    header.address = datagram.address;
    send_one(header, datagram.payload);
  }
  // Before the first clock reading there is no watermark.
  watermark_ = std::max(watermark_, batch.watermark);
  if (batch.datagrams.empty()) {
    header.kind = RelayHeader::Kind::kTick;
    header.time = header.watermark = watermark_;
    send_one(header, {});
  }
  return {};
}

void RelaySender::lose(bool tick, const char* reason) {
  if (!tick) {
    ++counters_.lost_by[reason];
  }
}

void RelaySender::send_one(RelayHeader& header, std::span<const std::byte> payload) {
  header.sequence = sequence_;
  const bool tick = header.kind == RelayHeader::Kind::kTick;
  sequence_ += tick ? 0 : 1;
  counters_.given += tick ? 0 : 1;
  if (fd_ < 0) {
    lose(tick, "not_there");
    return;
  }
  auto bytes = encode_relay_header(header);
  // sendmsg() takes buffers that are not const, and does not write to them.
  std::array<iovec, 2> parts{
      {{.iov_base = bytes.data(), .iov_len = bytes.size()},
       {.iov_base = const_cast<std::byte*>(payload.data()), .iov_len = payload.size()}}};
  msghdr message{};
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  ssize_t sent = -1;
  do {
    sent = sendmsg(fd_, &message, MSG_NOSIGNAL | (stalled_ || tick ? MSG_DONTWAIT : 0));
  } while (sent < 0 && errno == EINTR);
  if (sent >= 0) {
    stalled_ = false;
    counters_.delivered += tick ? 0 : 1;
    counters_.bytes += payload.size();
  } else if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
    stalled_ = stalled_ || !tick;
    lose(tick, "not_taken");
  } else {
    disconnect();
    lose(tick, "not_there");
  }
}

}  // namespace rayloc
