#include "capture/transport/udp_sender.h"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "capture/transport/udp_address.h"

namespace rayloc {
namespace {

constexpr std::size_t kMessagesACall = 64;

tl::unexpected<Error> cannot_send(const std::string& what) {
  return make_error(ErrorKind::kUnavailable, what + ": " + std::strerror(errno));
}

}  // namespace

Expected<std::unique_ptr<UdpSender>> UdpSender::open(const std::string& address) {
  const auto destination = parse_udp_address(address);
  RAYLOC_TRY(destination);
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  std::unique_ptr<UdpSender> sender(new UdpSender(fd, *destination));
  if (fd < 0 || setsockopt(fd, SOL_SOCKET, SO_BROADCAST, &on, sizeof on) != 0) {
    return cannot_send("cannot open a UDP socket");
  }
  return sender;
}

std::string UdpSender::description() const { return "udp " + to_string(destination_); }

Expected<void> UdpSender::write(const DatagramBatch& batch) {
  counters_.given += batch.datagrams.size();
  const std::uint64_t before = counters_.delivered;
  std::span<const Datagram> left(batch.datagrams);
  while (!left.empty()) {
    const auto now = left.first(std::min(left.size(), kMessagesACall));
    left = left.subspan(now.size());
    if (auto sent = send(now); !sent) {
      ++counters_.errors;
      counters_.lost_by["not_sent"] += batch.datagrams.size() - (counters_.delivered - before);
      return sent;
    }
  }
  return {};
}

// REQUIRES: at most kMessagesACall.
Expected<void> UdpSender::send(std::span<const Datagram> datagrams) {
  std::array<iovec, kMessagesACall> vectors{};
  std::array<mmsghdr, kMessagesACall> messages{};
  for (std::size_t i = 0; i < datagrams.size(); ++i) {
    // sendmmsg() takes buffers that are not const, and does not write to them.
    vectors[i] = {.iov_base = const_cast<std::byte*>(datagrams[i].payload.data()),
                  .iov_len = datagrams[i].payload.size()};
    messages[i].msg_hdr.msg_name = &destination_;
    messages[i].msg_hdr.msg_namelen = sizeof destination_;
    messages[i].msg_hdr.msg_iov = &vectors[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
  std::size_t done = 0;
  while (done < datagrams.size()) {
    const auto left = static_cast<unsigned>(datagrams.size() - done);
    const int sent = sendmmsg(fd_.get(), messages.data() + done, left, 0);
    if (sent < 0 && errno == EINTR) {
      continue;
    }
    if (sent < 0) {
      return cannot_send("cannot send to " + to_string(destination_));
    }
    for (int i = 0; i < sent; ++i, ++done) {
      ++counters_.delivered;
      counters_.bytes += datagrams[done].payload.size();
    }
  }
  return {};
}

}  // namespace rayloc
