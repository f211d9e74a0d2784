#include "capture/source/unix_source.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <optional>
#include <vector>

#include "capture/source/event_clock.h"
#include "capture/source/transport_schemes.h"
#include "capture/source/udp_source.h"
#include "capture/transport/file_descriptor.h"
#include "capture/transport/poll_timeout.h"
#include "capture/transport/relay_sender.h"
#include "capture/transport/relayed_datagram.h"

namespace rayloc {
namespace {

constexpr std::size_t kUnixBatchDatagrams = 64;
constexpr std::size_t kMessageBytes = kRelayHeaderBytes + UdpSource::kMaxDatagramBytes;
// Maximum delay of the sender before the time advances without it.
constexpr Duration kSenderPatience = std::chrono::seconds(1);

tl::unexpected<Error> unix_unavailable(const std::string& what) {
  return make_error(ErrorKind::kUnavailable, what + ": " + std::strerror(errno));
}

std::optional<uid_t> sender_of(msghdr& message) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_CREDENTIALS) {
      ucred credentials{};
      std::memcpy(&credentials, CMSG_DATA(c), sizeof credentials);
      return credentials.uid;
    }
  }
  return std::nullopt;
}

// Returns true if a process reads from the socket at `path`.
bool in_use(const sockaddr_un& address) {
  const FileDescriptor fd(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  return fd.get() >= 0 &&
         connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

Expected<int> bind_socket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    return make_error(ErrorKind::kUsage,
                      path + ": the path of a socket has at most " +
                          std::to_string(sizeof address.sun_path - 1) + " characters");
  }
  std::copy(path.begin(), path.end(), &address.sun_path[0]);
  struct stat there {};
  if (stat(path.c_str(), &there) == 0 && S_ISSOCK(there.st_mode)) {
    if (in_use(address)) {
      errno = EADDRINUSE;
      return unix_unavailable("unix " + path);
    }
    unlink(path.c_str());
  }
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    return unix_unavailable("unix " + path);
  }
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const auto error = unix_unavailable("unix " + path + ": cannot listen here");
    close(fd);
    return error;
  }
  return fd;
}

}  // namespace

class UnixSource::Impl {
 public:
  Impl(int fd, std::string path);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Expected<void> read(DatagramBatch& batch, Duration timeout);
  SourceCounters counters() const {
    const std::lock_guard lock(mutex_);
    return published_;
  }
  std::string description() const {
    return path_.empty() ? "unix socket " + std::to_string(fd_) : "unix " + path_;
  }
  int descriptor() const { return fd_; }

 private:
  Expected<std::size_t> receive();
  void take(mmsghdr& message, std::span<const std::byte> bytes, DatagramBatch& batch);
  void count_losses(const RelayHeader& header);
  void reject(const char* reason);

  const int fd_;
  const std::string path_;  // path to remove; empty for a socket that was passed
  const uid_t user_;
  EventClock clock_{kSenderPatience};
  Timestamp watermark_ = Timestamp::min();
  std::optional<RelayHeader> last_;  // last header of the current sender
  std::vector<std::byte> buffer_ = std::vector<std::byte>(kUnixBatchDatagrams * kMessageBytes);
  std::array<std::array<std::byte, CMSG_SPACE(sizeof(ucred))>, kUnixBatchDatagrams> control_{};
  std::array<iovec, kUnixBatchDatagrams> vectors_{};
  std::array<mmsghdr, kUnixBatchDatagrams> messages_{};
  SourceCounters counting_;  // used by the reading thread only

  mutable std::mutex mutex_;
  SourceCounters published_;
};

UnixSource::Impl::Impl(int fd, std::string path)
    : fd_(fd), path_(std::move(path)), user_(geteuid()) {
  for (std::size_t i = 0; i < kUnixBatchDatagrams; ++i) {
    vectors_[i] = {.iov_base = buffer_.data() + i * kMessageBytes, .iov_len = kMessageBytes};
    messages_[i].msg_hdr.msg_iov = &vectors_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = control_[i].data();
  }
}

UnixSource::Impl::~Impl() {
  close(fd_);
  if (!path_.empty()) {
    unlink(path_.c_str());
  }
}

Expected<std::size_t> UnixSource::Impl::receive() {
  for (mmsghdr& message : messages_) {
    message.msg_hdr.msg_controllen = control_[0].size();
  }
  clock_.observe_now();
  const int got = recvmmsg(fd_, messages_.data(), kUnixBatchDatagrams, MSG_DONTWAIT, nullptr);
  if (got >= 0) {
    return static_cast<std::size_t>(got);
  }
  if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) {
    return std::size_t{0};
  }
  return unix_unavailable(description() + ": cannot receive");
}

Expected<void> UnixSource::Impl::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  batch.ended = false;
  auto got = receive();
  if (got && *got == 0) {
    pollfd waiting{.fd = fd_, .events = POLLIN, .revents = 0};
    poll(&waiting, 1, poll_milliseconds(timeout));
    got = receive();
  }
  RAYLOC_TRY(got);
  const std::span<const std::byte> buffer(buffer_);
  for (std::size_t i = 0; i < *got; ++i) {
    const std::size_t size = std::min<std::size_t>(messages_[i].msg_len, kMessageBytes);
    take(messages_[i], buffer.subspan(i * kMessageBytes, size), batch);
  }
  if (*got < kUnixBatchDatagrams) {
    clock_.drained();
  }
  watermark_ = std::max(watermark_, clock_.watermark());
  batch.watermark = watermark_;
  const std::lock_guard lock(mutex_);
  published_ = counting_;
  return {};
}

void UnixSource::Impl::reject(const char* reason) {
  ++counting_.received;
  ++counting_.rejected[reason];
}

void UnixSource::Impl::take(mmsghdr& message,
                            std::span<const std::byte> bytes,
                            DatagramBatch& batch) {
  const std::optional<uid_t> sender = sender_of(message.msg_hdr);
  if (!sender || (*sender != user_ && *sender != 0)) {
    reject("stranger");
    return;
  }
  if ((message.msg_hdr.msg_flags & MSG_TRUNC) != 0) {
    reject("oversized");
    return;
  }
  const std::optional<RelayHeader> header = decode_relay_header(bytes);
  if (!header) {
    reject("not_relayed");
    return;
  }
  count_losses(*header);
  if (header->kind == RelayHeader::Kind::kDatagram) {
    Datagram datagram;
    datagram.time = std::max(header->time, watermark_);
    datagram.address = header->address;
    datagram.payload = bytes.subspan(kRelayHeaderBytes);
    ++counting_.received;
    ++counting_.delivered;
    counting_.bytes += datagram.payload.size();
    batch.datagrams.push_back(datagram);
  }
  watermark_ = std::max(watermark_, header->watermark);
}

// The sender's counts grow within one of its runs. Its losses before we started are not counted.
void UnixSource::Impl::count_losses(const RelayHeader& header) {
  const bool same_run = last_ && last_->epoch == header.epoch;
  RelayHeader before = same_run ? *last_ : RelayHeader{};
  if (!last_) {
    before = header;
  }
  const auto growth = [](std::uint64_t now, std::uint64_t then) {
    return now - std::min(now, then);
  };
  counting_.kernel_drops +=
      growth(header.sequence, before.sequence) + growth(header.kernel_drops, before.kernel_drops);
  if (const std::uint64_t rejected = growth(header.rejected, before.rejected); rejected > 0) {
    counting_.received += rejected;
    counting_.rejected["rayloc_capture"] += rejected;
  }
  last_ = header;
  // The next expected sequence number.
  last_->sequence += header.kind == RelayHeader::Kind::kDatagram ? 1 : 0;
}

Expected<std::unique_ptr<UnixSource>> UnixSource::open(const UnixSourceOptions& options) {
  int fd = options.adopted_fd;
  if (fd < 0) {
    const Expected<int> bound = bind_socket(options.path);
    RAYLOC_TRY(bound);
    fd = *bound;
  }
  const int on = 1;
  int family = 0;
  socklen_t size = sizeof family;
  if (getsockopt(fd, SOL_SOCKET, SO_DOMAIN, &family, &size) != 0 || family != AF_UNIX ||
      setsockopt(fd, SOL_SOCKET, SO_PASSCRED, &on, sizeof on) != 0) {
    close(fd);
    return make_error(ErrorKind::kUnavailable,
                      "unix socket " + std::to_string(fd) +
                          ": no AF_UNIX datagram socket; in its unit write ListenDatagram=/PATH");
  }
  return std::unique_ptr<UnixSource>(new UnixSource(
      std::make_unique<Impl>(fd, options.adopted_fd < 0 ? options.path : std::string())));
}

UnixSource::UnixSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
UnixSource::~UnixSource() = default;

Expected<void> UnixSource::read(DatagramBatch& batch, Duration timeout) {
  return impl_->read(batch, timeout);
}
SourceCounters UnixSource::counters() const { return impl_->counters(); }
std::string UnixSource::description() const { return impl_->description(); }
std::optional<int> UnixSource::poll_descriptor() const { return impl_->descriptor(); }

const TransportScheme kUnixScheme{
    .name = "unix",
    .address = "PATH",
    .example = "unix:/run/raylocd/eth0",
    .summary = "a socket of this machine, where rayloc-capture sends to",
    .open_source =
        [](const std::string& address, const SourceOptions& options) {
          UnixSourceOptions socket;
          socket.path = address;
          socket.adopted_fd = options.adopted_fd;
          return as_transport<DatagramSource>(UnixSource::open(socket));
        },
    .open_sink =
        [](const std::string& address) {
          return as_transport<DatagramSink>(RelaySender::open(address));
        },
};

}  // namespace rayloc
