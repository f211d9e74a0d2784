#include "capture/source/pcap_live_source.h"

#include <pcap/pcap.h>
#include <poll.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <vector>

#include "capture/record/pcap_packet.h"
#include "capture/source/event_clock.h"
#include "capture/source/transport_schemes.h"
#include "capture/transport/poll_timeout.h"

namespace rayloc {

// Not in an unnamed namespace: a member of PcapLiveSource::Impl.
struct ClosePcapHandle {
  void operator()(pcap_t* handle) const { pcap_close(handle); }
};
using PcapHandle = std::unique_ptr<pcap_t, ClosePcapHandle>;

namespace {

// Longer than any CSI datagram with its headers; cut packets are counted "truncated_capture".
constexpr int kSnapLength = 8192;
constexpr int kBatchPackets = 256;

tl::unexpected<Error> activation_error(pcap_t* handle, const std::string& interface, int status) {
  std::string message = "interface " + interface + ": " + pcap_statustostr(status);
  if (const char* detail = pcap_geterr(handle); *detail != '\0') {
    message += std::string(" (") + detail + ")";
  }
  if (status == PCAP_ERROR_PERM_DENIED) {
    message += "; run as root, or allow it: setcap cap_net_raw+ep PROGRAM";
  } else if (status == PCAP_ERROR_NO_SUCH_DEVICE) {
    message += "; ip link lists what there is";
  }
  return make_error(ErrorKind::kUnavailable, message);
}

Expected<void> set_filter(pcap_t* handle, const std::string& filter) {
  bpf_program program{};
  if (pcap_compile(handle, &program, filter.c_str(), 1, PCAP_NETMASK_UNKNOWN) != 0) {
    return make_error(ErrorKind::kUsage,
                      "filter '" + filter + "': " + pcap_geterr(handle) + "; see pcap-filter(7)");
  }
  const int status = pcap_setfilter(handle, &program);
  pcap_freecode(&program);
  if (status != 0) {
    return make_error(ErrorKind::kUnavailable, "filter '" + filter + "': " + pcap_geterr(handle));
  }
  return {};
}

}  // namespace

class PcapLiveSource::Impl {
 public:
  Impl(PcapHandle handle, std::string interface)
      : handle_(std::move(handle)),
        interface_(std::move(interface)),
        link_type_(static_cast<std::uint32_t>(pcap_datalink(handle_.get()))),
        fraction_(pcap_get_tstamp_precision(handle_.get()) == PCAP_TSTAMP_PRECISION_NANO ? 1
                                                                                         : 1000) {}

  Expected<void> read(DatagramBatch& batch, Duration timeout);
  SourceCounters counters() const {
    const std::lock_guard lock(mutex_);
    return published_;
  }
  const std::string& interface() const { return interface_; }
  int descriptor() const { return pcap_get_selectable_fd(handle_.get()); }

 private:
  Expected<int> dispatch();
  static void handle_packet(u_char* self, const pcap_pkthdr* header, const u_char* bytes);
  void take(const pcap_pkthdr& header, const u_char* bytes);
  void count_drops();

  const PcapHandle handle_;
  const std::string interface_;
  const std::uint32_t link_type_;
  const std::int64_t fraction_;  // nanoseconds per unit of tv_usec
  EventClock clock_;
  // libpcap's buffer is valid in the callback only, so payloads are copied one after the other.
  // Datagrams refer to the copies once all are complete.
  std::vector<std::byte> payloads_;
  std::vector<Datagram> taken_;
  std::vector<std::size_t> sizes_;
  std::uint32_t last_drops_ = 0;
  SourceCounters counting_;  // used by the reading thread only

  mutable std::mutex mutex_;
  SourceCounters published_;
};

void PcapLiveSource::Impl::handle_packet(u_char* self,
                                         const pcap_pkthdr* header,
                                         const u_char* bytes) {
  reinterpret_cast<Impl*>(self)->take(*header, bytes);
}

void PcapLiveSource::Impl::take(const pcap_pkthdr& header, const u_char* bytes) {
  ++counting_.received;
  const Timestamp stamp(std::chrono::seconds(header.ts.tv_sec) +
                        Duration(header.ts.tv_usec * fraction_));
  pcap::Packet packet;
  packet.time = clock_.event_time(stamp);
  packet.link_type = link_type_;
  packet.original_length = header.len;
  packet.data = std::as_bytes(std::span(bytes, header.caplen));
  const char* through = nullptr;
  const auto datagram = pcap::udp_datagram(packet, std::nullopt, &through);
  if (!datagram) {
    ++counting_.rejected[datagram.error()];
    return;
  }
  if (through != nullptr) {
    ++counting_.unwrapped[through];
  }
  ++counting_.delivered;
  counting_.bytes += datagram->payload.size();
  payloads_.insert(payloads_.end(), datagram->payload.begin(), datagram->payload.end());
  sizes_.push_back(datagram->payload.size());
  taken_.push_back(*datagram);
}

// Returns the number of packets that were waiting, at most a batch.
Expected<int> PcapLiveSource::Impl::dispatch() {
  clock_.observe_now();
  const int got = pcap_dispatch(
      handle_.get(), kBatchPackets, &Impl::handle_packet, reinterpret_cast<u_char*>(this));
  if (got < 0) {
    return make_error(ErrorKind::kUnavailable,
                      "interface " + interface_ + ": " + pcap_geterr(handle_.get()));
  }
  return got;
}

Expected<void> PcapLiveSource::Impl::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  batch.ended = false;
  payloads_.clear();
  taken_.clear();
  sizes_.clear();
  auto got = dispatch();
  if (got && *got == 0) {
    pollfd waiting{.fd = descriptor(), .events = POLLIN, .revents = 0};
    poll(&waiting, 1, poll_milliseconds(timeout));
    got = dispatch();
  }
  RAYLOC_TRY(got);
  std::span<const std::byte> rest(payloads_);
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    taken_[i].payload = rest.first(sizes_[i]);
    rest = rest.subspan(sizes_[i]);
  }
  batch.datagrams.swap(taken_);
  if (*got == 0) {
    clock_.drained();
  } else if (!batch.datagrams.empty()) {
    clock_.not_drained(batch.datagrams.back().time);
  }
  batch.watermark = clock_.watermark();
  counting_.clock_steps = clock_.steps();
  count_drops();
  const std::lock_guard lock(mutex_);
  published_ = counting_;
  return {};
}

void PcapLiveSource::Impl::count_drops() {
  pcap_stat stats{};
  if (pcap_stats(handle_.get(), &stats) != 0) {
    return;
  }
  // Both counters run from the beginning, modulo 2^32.
  const std::uint32_t drops = stats.ps_drop + stats.ps_ifdrop;
  counting_.kernel_drops += static_cast<std::uint32_t>(drops - last_drops_);
  last_drops_ = drops;
}

Expected<std::unique_ptr<PcapLiveSource>> PcapLiveSource::open(const PcapLiveOptions& options) {
  std::array<char, PCAP_ERRBUF_SIZE> error{};
  PcapHandle handle(pcap_create(options.interface.c_str(), error.data()));
  if (!handle) {
    return make_error(ErrorKind::kUnavailable,
                      "interface " + options.interface + ": " + error.data());
  }
  pcap_set_snaplen(handle.get(), kSnapLength);
  pcap_set_buffer_size(handle.get(), options.buffer_bytes);
  pcap_set_immediate_mode(handle.get(), 1);
  pcap_set_tstamp_precision(handle.get(), PCAP_TSTAMP_PRECISION_NANO);
  const int status = pcap_activate(handle.get());
  if (status < 0) {
    return activation_error(handle.get(), options.interface, status);
  }
  RAYLOC_TRY(set_filter(handle.get(), options.filter));
  if (pcap_setnonblock(handle.get(), 1, error.data()) != 0) {
    return make_error(ErrorKind::kUnavailable,
                      "interface " + options.interface + ": " + error.data());
  }
  return std::unique_ptr<PcapLiveSource>(
      new PcapLiveSource(std::make_unique<Impl>(std::move(handle), options.interface)));
}

PcapLiveSource::PcapLiveSource(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PcapLiveSource::~PcapLiveSource() = default;

Expected<void> PcapLiveSource::read(DatagramBatch& batch, Duration timeout) {
  return impl_->read(batch, timeout);
}
SourceCounters PcapLiveSource::counters() const { return impl_->counters(); }
std::string PcapLiveSource::description() const { return "interface " + impl_->interface(); }
std::optional<int> PcapLiveSource::poll_descriptor() const { return impl_->descriptor(); }

const TransportScheme kLiveScheme{
    .name = "live",
    .address = "INTERFACE",
    .example = "live:eth0",
    .summary = "packets on a network interface (libpcap, needs CAP_NET_RAW)",
    .open_source =
        [](const std::string& address, const SourceOptions& options) {
          PcapLiveOptions live;
          live.interface = address;
          live.filter = options.filter.empty() ? live.filter : options.filter;
          return as_transport<DatagramSource>(PcapLiveSource::open(live));
        },
};

}  // namespace rayloc
