#include "capture/transport/udp_sender.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "capture/transport/udp_address.h"

namespace rayloc::cli {
namespace {

tl::unexpected<Error> cannot_send(const std::string& what) {
  return make_error(ErrorKind::kUnavailable, what + ": " + std::strerror(errno));
}

}  // namespace

Expected<DatagramSender> DatagramSender::create(std::vector<sockaddr_in> destinations) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  if (fd < 0 || setsockopt(fd, SOL_SOCKET, SO_BROADCAST, &on, sizeof on) != 0) {
    return cannot_send("cannot open a UDP socket");
  }
  return DatagramSender(fd, std::move(destinations));
}

DatagramSender::DatagramSender(int fd, std::vector<sockaddr_in> destinations)
    : fd_(fd), destinations_(std::move(destinations)) {}

DatagramSender::DatagramSender(DatagramSender&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      destinations_(std::move(other.destinations_)),
      queued_(std::move(other.queued_)),
      payloads_(std::move(other.payloads_)),
      sent_(other.sent_),
      bytes_(other.bytes_) {}

DatagramSender::~DatagramSender() {
  if (fd_ >= 0) {
    close(fd_);
  }
}

Expected<void> DatagramSender::queue(std::size_t destination, std::span<const std::byte> payload) {
  queued_.push_back({destination, payload.size()});
  payloads_.insert(payloads_.end(), payload.begin(), payload.end());
  return queued_.size() == kBatch ? flush() : Expected<void>();
}

Expected<void> DatagramSender::flush() {
  std::array<iovec, kBatch> vectors{};
  std::array<mmsghdr, kBatch> messages{};
  std::size_t at = 0;
  for (std::size_t i = 0; i < queued_.size(); ++i) {
    vectors[i] = {.iov_base = payloads_.data() + at, .iov_len = queued_[i].size};
    at += queued_[i].size;
    messages[i].msg_hdr.msg_name = &destinations_[queued_[i].destination];
    messages[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
    messages[i].msg_hdr.msg_iov = &vectors[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
  std::size_t done = 0;
  while (done < queued_.size()) {
    const auto left = static_cast<unsigned>(queued_.size() - done);
    const int sent = sendmmsg(fd_, messages.data() + done, left, 0);
    if (sent < 0 && errno == EINTR) {
      continue;
    }
    if (sent < 0) {
      return cannot_send("cannot send to " + to_string(destinations_[queued_[done].destination]));
    }
    for (int i = 0; i < sent; ++i, ++done) {
      ++sent_;
      bytes_ += queued_[done].size;
    }
  }
  queued_.clear();
  payloads_.clear();
  return {};
}

}  // namespace rayloc::cli
