#include "capture/source/udp_source.h"

#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <mutex>
#include <optional>
#include <vector>

#include "capture/source/event_clock.h"
#include "capture/source/transport_schemes.h"
#include "capture/transport/file_descriptor.h"
#include "capture/transport/interface_filter.h"
#include "capture/transport/poll_timeout.h"
#include "capture/transport/udp_address.h"
#include "capture/transport/udp_sender.h"

namespace rayloc {
namespace {

constexpr std::size_t kUdpBatchDatagrams = 64;
constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(timespec)) +
                                      CMSG_SPACE(sizeof(in_pktinfo)) +
                                      CMSG_SPACE(sizeof(std::uint32_t));

tl::unexpected<Error> udp_unavailable(const std::string& what) {
  return make_error(ErrorKind::kUnavailable, what + ": " + std::strerror(errno));
}

bool switch_on(int fd, int level, int option) {
  const int on = 1;
  return setsockopt(fd, level, option, &on, sizeof on) == 0;
}

// The requested size: the kernel doubles it, socket(7).
int receive_buffer(int fd) {
  int bytes = 0;
  socklen_t size = sizeof bytes;
  getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, &size);
  return bytes / 2;
}

// The size that SO_RCVBUF grants for a request: it is limited to net.core.rmem_max, which a sandbox
// hides, so it is measured.
int granted_receive_buffer(int bytes) {
  const FileDescriptor trial(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  setsockopt(trial.get(), SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  return receive_buffer(trial.get());
}

// SO_RCVBUFFORCE needs CAP_NET_ADMIN. Without it a buffer that systemd (ReceiveBuffer=) made larger
// than we may would become smaller.
void set_receive_buffer(int fd, int bytes, bool adopted) {
  if (adopted && receive_buffer(fd) >= bytes) {
    return;
  }
  if (setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0 &&
      (!adopted || receive_buffer(fd) < granted_receive_buffer(bytes))) {
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  }
}

// Number of datagrams the socket has lost since it was opened, modulo 2^32; empty if the kernel
// does not report it.
std::optional<std::uint32_t> dropped_datagrams(int fd) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  return getsockopt(fd, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0 &&
                 size > SK_MEMINFO_DROPS * sizeof(std::uint32_t)
             ? std::optional(memory[SK_MEMINFO_DROPS])
             : std::nullopt;
}

// The kernel's control data for one datagram.
struct Ancillary {
  std::optional<timespec> stamp;
  std::optional<in_pktinfo> arrival;
  std::optional<std::uint32_t> drops;
};

template <typename T>
void copy_control(const cmsghdr* header, std::optional<T>& to) {
  T value;
  std::memcpy(&value, CMSG_DATA(header), sizeof value);
  to = value;
}

Ancillary read_ancillary(msghdr& message) {
  Ancillary all;
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_TIMESTAMPNS) {
      copy_control(c, all.stamp);
    } else if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL) {
      copy_control(c, all.drops);
    } else if (c->cmsg_level == IPPROTO_IP && c->cmsg_type == IP_PKTINFO) {
      copy_control(c, all.arrival);
    }
  }
  return all;
}

Timestamp to_timestamp(const timespec& time) {
  return Timestamp(std::chrono::seconds(time.tv_sec) + Duration(time.tv_nsec));
}

// Returns false for a sender without an IPv4 address. A socket that systemd bound to [::] reports
// IPv4 senders as ::ffff:a.b.c.d.
bool read_sender(const sockaddr_storage& name, DatagramAddress& address) {
  if (name.ss_family == AF_INET) {
    sockaddr_in from{};
    std::memcpy(&from, &name, sizeof from);
    address.source_ip = ntohl(from.sin_addr.s_addr);
    address.source_port = ntohs(from.sin_port);
    return true;
  }
  sockaddr_in6 from{};
  std::memcpy(&from, &name, sizeof from);
  if (name.ss_family != AF_INET6 || !IN6_IS_ADDR_V4MAPPED(&from.sin6_addr)) {
    return false;
  }
  std::uint32_t ip = 0;
  std::memcpy(&ip, &from.sin6_addr.s6_addr[12], sizeof ip);
  address.source_ip = ntohl(ip);
  address.source_port = ntohs(from.sin6_port);
  return true;
}

}  // namespace

class UdpSource::Impl {
 public:
  Impl(int fd, int wake_fd, std::string description, const UdpSourceOptions& options);

  Expected<void> set_up(const UdpSourceOptions& options);
  Expected<void> read(DatagramBatch& batch, Duration timeout);
  SourceCounters counters() const {
    const std::lock_guard lock(mutex_);
    return published_;
  }
  const std::string& description() const { return description_; }
  void wake() const { eventfd_write(wake_fd_.get(), 1); }
  std::uint16_t port() const { return port_; }
  const ReceiveBuffer& receive_buffer() const { return buffer_granted_; }
  int descriptor() const { return fd_.get(); }

 private:
  Expected<std::size_t> receive();
  bool wait(Duration timeout) const;
  void take(mmsghdr& message, std::span<const std::byte> payload, DatagramBatch& batch);
  const char* admit(mmsghdr& message, const Ancillary& ancillary, DatagramAddress& address);
  void count_drops(std::uint32_t total);
  void count_drops_of_idle_socket();

  const FileDescriptor fd_;
  const FileDescriptor wake_fd_;
  const std::string description_;
  InterfaceFilter interface_;
  const std::vector<AddressRange> senders_;
  std::uint16_t port_ = 0;
  ReceiveBuffer buffer_granted_;

  EventClock clock_;
  std::vector<std::byte> buffer_ = std::vector<std::byte>(kUdpBatchDatagrams * kMaxDatagramBytes);
  std::array<std::array<std::byte, kControlBytes>, kUdpBatchDatagrams> control_{};
  std::array<sockaddr_storage, kUdpBatchDatagrams> names_{};
  std::array<iovec, kUdpBatchDatagrams> vectors_{};
  std::array<mmsghdr, kUdpBatchDatagrams> messages_{};
  std::uint32_t last_drops_ = 0;
  SourceCounters counting_;  // used by the reading thread only

  mutable std::mutex mutex_;
  SourceCounters published_;
};

UdpSource::Impl::Impl(int fd, int wake_fd, std::string description, const UdpSourceOptions& options)
    : fd_(fd),
      wake_fd_(wake_fd),
      description_(std::move(description)),
      interface_(options.interface),
      senders_(options.senders) {
  for (std::size_t i = 0; i < kUdpBatchDatagrams; ++i) {
    vectors_[i] = {.iov_base = buffer_.data() + i * kMaxDatagramBytes,
                   .iov_len = kMaxDatagramBytes};
    messages_[i].msg_hdr.msg_iov = &vectors_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_name = &names_[i];
    messages_[i].msg_hdr.msg_control = control_[i].data();
  }
}

Expected<void> UdpSource::Impl::set_up(const UdpSourceOptions& options) {
  if (!interface_.exists()) {
    return make_error(ErrorKind::kUnavailable,
                      description_ + ": there is no interface '" + options.interface +
                          "'; ip link lists what there is");
  }
  if (!switch_on(fd_.get(), SOL_SOCKET, SO_TIMESTAMPNS) ||
      !switch_on(fd_.get(), SOL_SOCKET, SO_RXQ_OVFL) ||
      !switch_on(fd_.get(), IPPROTO_IP, IP_PKTINFO)) {
    return udp_unavailable(description_ + ": the socket cannot be set up");
  }
  const bool adopted = options.adopted_fd >= 0;
  set_receive_buffer(fd_.get(), options.receive_buffer_bytes, adopted);
  buffer_granted_.wanted_bytes = options.receive_buffer_bytes;
  buffer_granted_.granted_bytes = ::rayloc::receive_buffer(fd_.get());
  if (adopted) {
    buffer_granted_.dropped_before = dropped_datagrams(fd_.get()).value_or(0);
    last_drops_ = buffer_granted_.dropped_before;
  }
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  // sockaddr is the type of the interface; the family determines the actual type.
  if (getsockname(fd_.get(), reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
    return udp_unavailable(description_ + ": the socket has no address");
  }
  sockaddr_in6 v6{};
  std::memcpy(&v6, &bound, sizeof v6);
  // The port is at the same offset in both families.
  port_ = ntohs(v6.sin6_port);
  return {};
}

// Returns the number of datagrams that were waiting; at most a batch.
Expected<std::size_t> UdpSource::Impl::receive() {
  for (mmsghdr& message : messages_) {
    message.msg_hdr.msg_namelen = sizeof(sockaddr_storage);
    message.msg_hdr.msg_controllen = kControlBytes;
  }
  clock_.observe_now();
  const int got = recvmmsg(fd_.get(), messages_.data(), kUdpBatchDatagrams, MSG_DONTWAIT, nullptr);
  if (got >= 0) {
    return static_cast<std::size_t>(got);
  }
  if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) {
    return std::size_t{0};
  }
  return udp_unavailable(description_ + ": cannot receive");
}

// Returns false if it was woken or timed out.
bool UdpSource::Impl::wait(Duration timeout) const {
  std::array<pollfd, 2> waiting{{{.fd = fd_.get(), .events = POLLIN, .revents = 0},
                                 {.fd = wake_fd_.get(), .events = POLLIN, .revents = 0}}};
  if (poll(waiting.data(), waiting.size(), poll_milliseconds(timeout)) <= 0) {
    return false;
  }
  if (waiting[1].revents != 0) {
    eventfd_t ignored = 0;
    eventfd_read(wake_fd_.get(), &ignored);
  }
  return waiting[0].revents != 0;
}

Expected<void> UdpSource::Impl::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  batch.ended = false;
  auto got = receive();
  if (got && *got == 0) {
    wait(timeout);
    // Repeated in any case: the empty socket gives a watermark of now.
    got = receive();
  }
  RAYLOC_TRY(got);
  const std::span<const std::byte> buffer(buffer_);
  for (std::size_t i = 0; i < *got; ++i) {
    const std::size_t size = std::min<std::size_t>(messages_[i].msg_len, kMaxDatagramBytes);
    take(messages_[i], buffer.subspan(i * kMaxDatagramBytes, size), batch);
  }
  if (*got < kUdpBatchDatagrams) {
    clock_.drained();
    count_drops_of_idle_socket();
  } else if (!batch.datagrams.empty()) {
    clock_.not_drained(batch.datagrams.back().time);
  }
  batch.watermark = clock_.watermark();
  counting_.clock_steps = clock_.steps();
  const std::lock_guard lock(mutex_);
  published_ = counting_;
  return {};
}

// Returns the reason for which the datagram is rejected, or nullptr.
const char* UdpSource::Impl::admit(mmsghdr& message,
                                   const Ancillary& ancillary,
                                   DatagramAddress& address) {
  sockaddr_storage name{};
  std::memcpy(&name, message.msg_hdr.msg_name, sizeof name);
  if (!read_sender(name, address)) {
    return "ipv6";
  }
  if (!ancillary.stamp || !ancillary.arrival) {
    return "no_timestamp";
  }
  address.destination_ip = ntohl(ancillary.arrival->ipi_addr.s_addr);
  address.destination_port = port_;
  if (!interface_.admits(static_cast<unsigned>(ancillary.arrival->ipi_ifindex))) {
    return "interface_not_allowed";
  }
  const auto has_sender = [&](const AddressRange& range) {
    return range.contains(address.source_ip);
  };
  if (!senders_.empty() && std::none_of(senders_.begin(), senders_.end(), has_sender)) {
    return "sender_not_allowed";
  }
  return (message.msg_hdr.msg_flags & MSG_TRUNC) != 0 ? "oversized" : nullptr;
}

void UdpSource::Impl::take(mmsghdr& message,
                           std::span<const std::byte> payload,
                           DatagramBatch& batch) {
  ++counting_.received;
  const Ancillary ancillary = read_ancillary(message.msg_hdr);
  if (ancillary.drops) {
    count_drops(*ancillary.drops);
  }
  Datagram datagram;
  if (const char* reason = admit(message, ancillary, datagram.address)) {
    ++counting_.rejected[reason];
    return;
  }
  datagram.time = clock_.event_time(to_timestamp(*ancillary.stamp));
  datagram.payload = payload;
  ++counting_.delivered;
  counting_.bytes += payload.size();
  batch.datagrams.push_back(datagram);
}

// `total` counts since the socket was opened, modulo 2^32. A datagram that was queued before the
// last query of the idle socket has an older total.
void UdpSource::Impl::count_drops(std::uint32_t total) {
  const std::uint32_t more = total - last_drops_;
  if (more < (1U << 31)) {
    counting_.kernel_drops += more;
    last_drops_ = total;
  }
}

// SO_RXQ_OVFL reports drops with the next datagram that fits; after the last one no report follows.
void UdpSource::Impl::count_drops_of_idle_socket() {
  if (const std::optional<std::uint32_t> dropped = dropped_datagrams(fd_.get())) {
    count_drops(*dropped);
  }
}

Expected<std::unique_ptr<UdpSource>> UdpSource::open(const UdpSourceOptions& options) {
  int fd = options.adopted_fd;
  std::string description = "udp socket " + std::to_string(fd);
  if (fd < 0) {
    const auto address = parse_udp_address(options.address);
    RAYLOC_TRY(address);
    description = "udp " + options.address;
    fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd < 0) {
      return udp_unavailable(description);
    }
    if (bind(fd, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0) {
      const auto error = udp_unavailable(description + ": cannot listen here");
      close(fd);
      return error;
    }
  }
  const int wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake_fd < 0) {
    const auto error = udp_unavailable(description);
    close(fd);
    return error;
  }
  auto impl = std::make_unique<Impl>(fd, wake_fd, description, options);
  RAYLOC_TRY(impl->set_up(options));
  return std::unique_ptr<UdpSource>(new UdpSource(std::move(impl)));
}

UdpSource::UdpSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
UdpSource::~UdpSource() = default;

Expected<void> UdpSource::read(DatagramBatch& batch, Duration timeout) {
  return impl_->read(batch, timeout);
}
SourceCounters UdpSource::counters() const { return impl_->counters(); }
std::string UdpSource::description() const { return impl_->description(); }
void UdpSource::wake() { impl_->wake(); }
std::uint16_t UdpSource::port() const { return impl_->port(); }
ReceiveBuffer UdpSource::receive_buffer() const { return impl_->receive_buffer(); }
std::optional<int> UdpSource::poll_descriptor() const { return impl_->descriptor(); }

const TransportScheme kUdpScheme{
    .name = "udp",
    .address = "HOST:PORT",
    .example = "udp:0.0.0.0:5500",
    .summary = "a UDP port, where access points send to",
    .open_source =
        [](const std::string& address, const SourceOptions& options) {
          UdpSourceOptions udp;
          udp.address = address;
          udp.interface = options.only_interface;
          udp.senders = options.senders;
          udp.adopted_fd = options.adopted_fd;
          return as_transport<DatagramSource>(UdpSource::open(udp));
        },
    .open_sink =
        [](const std::string& address) {
          return as_transport<DatagramSink>(UdpSender::open(address));
        },
};

}  // namespace rayloc
