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

Expected<RelaySender> RelaySender::create(const std::string& path) {
  if (path.empty() || path.size() >= sizeof(sockaddr_un::sun_path)) {
    return make_error(ErrorKind::kUsage,
                      "'" + path + "': write the path of a socket, at most " +
                          std::to_string(sizeof(sockaddr_un::sun_path) - 1) + " characters");
  }
  return RelaySender(path);
}

RelaySender::RelaySender(std::string path) : path_(std::move(path)), epoch_(draw_epoch()) {}

RelaySender::RelaySender(RelaySender&& other) noexcept
    : path_(std::move(other.path_)),
      fd_(std::exchange(other.fd_, -1)),
      stalled_(other.stalled_),
      epoch_(other.epoch_),
      sequence_(other.sequence_),
      watermark_(other.watermark_),
      counters_(other.counters_) {}

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

void RelaySender::send(const DatagramBatch& batch, const SourceCounters& source) {
  connect();
  RelayHeader header;
  header.epoch = epoch_;
  header.kernel_drops = source.kernel_drops;
  for (const auto& [reason, count] : source.rejected) {
    header.rejected += count;
  }
  for (std::size_t i = 0; i < batch.datagrams.size(); ++i) {
    const Datagram& datagram = batch.datagrams[i];
    // What the batch promises holds behind its last datagram.
    header.watermark =
        i + 1 < batch.datagrams.size() ? watermark_ : std::max(watermark_, batch.watermark);
    header.time = datagram.time;
    header.address = datagram.address;
    send_one(header, datagram.payload);
  }
  // Before the first look at the clock there is nothing to promise.
  watermark_ = std::max(watermark_, batch.watermark);
  if (batch.datagrams.empty()) {
    header.kind = RelayHeader::Kind::kTick;
    header.time = header.watermark = watermark_;
    send_one(header, {});
  }
}

void RelaySender::send_one(RelayHeader& header, std::span<const std::byte> payload) {
  header.sequence = sequence_;
  const bool tick = header.kind == RelayHeader::Kind::kTick;
  sequence_ += tick ? 0 : 1;
  if (fd_ < 0) {
    counters_.lost_absent += tick ? 0 : 1;
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
    counters_.sent += tick ? 0 : 1;
  } else if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
    stalled_ = stalled_ || !tick;
    counters_.lost_full += tick ? 0 : 1;
  } else {
    disconnect();
    counters_.lost_absent += tick ? 0 : 1;
  }
}

}  // namespace rayloc
