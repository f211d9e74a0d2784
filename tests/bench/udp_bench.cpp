// Measures how many datagrams a second a receiver takes from a UDP port without losing one, and the
// cost of each. The baseline is the least that a program can do: a bare recvmmsg loop.
//
//   udp_bench [RECORDING]     the datagrams to send; by default those of 566 bytes that calibrate
//                             the bundled meeting room
//
// Rates rise step by step; each is sent for two seconds by a process of its own. A rate counts when
// nothing is lost; a second try is allowed, for other programs run on the machine too.
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/source/pcap_source.h"
#include "capture/source/udp_source.h"
#include "tests/bench/udp_sender.h"
#include "tests/support/test_paths.h"

namespace rayloc::bench {
namespace {

constexpr int kReceiveBufferBytes = 8 << 20;
constexpr double kSecondsPerRate = 2;

// The receiver under test: takes what has arrived, waiting up to 10 ms; returns the count.
class Receiver {
 public:
  virtual ~Receiver() = default;
  virtual const char* name() const = 0;
  virtual std::uint16_t port() const = 0;
  virtual std::uint64_t receive() = 0;
};

class BareReceiver final : public Receiver {
 public:
  BareReceiver() : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    setsockopt(fd_, SOL_SOCKET, SO_RCVBUFFORCE, &kReceiveBufferBytes, sizeof kReceiveBufferBytes);
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof any;
    if (bind(fd_, reinterpret_cast<const sockaddr*>(&any), size) != 0 ||
        getsockname(fd_, reinterpret_cast<sockaddr*>(&any), &size) != 0) {
      std::perror("udp_bench");
    }
    port_ = ntohs(any.sin_port);
    for (std::size_t i = 0; i < kBatch; ++i) {
      vectors_[i] = {.iov_base = buffers_[i].data(), .iov_len = buffers_[i].size()};
      messages_[i].msg_hdr.msg_iov = &vectors_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
    }
  }
  ~BareReceiver() override { close(fd_); }
  BareReceiver(const BareReceiver&) = delete;
  BareReceiver& operator=(const BareReceiver&) = delete;

  const char* name() const override { return "bare recvmmsg"; }
  std::uint16_t port() const override { return port_; }
  std::uint64_t receive() override {
    int got = recvmmsg(fd_, messages_.data(), kBatch, MSG_DONTWAIT, nullptr);
    if (got <= 0) {
      pollfd waiting{.fd = fd_, .events = POLLIN, .revents = 0};
      poll(&waiting, 1, 10);
      got = recvmmsg(fd_, messages_.data(), kBatch, MSG_DONTWAIT, nullptr);
    }
    return got > 0 ? static_cast<std::uint64_t>(got) : 0;
  }

 private:
  static constexpr std::size_t kBatch = 64;
  int fd_;
  std::uint16_t port_ = 0;
  std::array<std::array<std::byte, 4096>, kBatch> buffers_;
  std::array<iovec, kBatch> vectors_{};
  std::array<mmsghdr, kBatch> messages_{};
};

class SourceReceiver : public Receiver {
 public:
  SourceReceiver() {
    UdpSourceOptions options;
    options.address = "127.0.0.1:0";
    options.receive_buffer_bytes = kReceiveBufferBytes;
    auto source = UdpSource::open(options);
    if (!source) {
      std::fprintf(stderr, "udp_bench: %s\n", source.error().message.c_str());
      std::exit(69);
    }
    source_ = std::move(*source);
  }
  const char* name() const override { return "UdpSource"; }
  std::uint16_t port() const override { return source_->port(); }
  std::uint64_t receive() override {
    if (!source_->read(batch_, std::chrono::milliseconds(10))) {
      return 0;
    }
    return batch_.datagrams.size();
  }

 protected:
  const DatagramBatch& batch() const { return batch_; }

 private:
  std::unique_ptr<UdpSource> source_;
  DatagramBatch batch_;
};

class FrameReceiver final : public SourceReceiver {
 public:
  const char* name() const override { return "UdpSource and CsiReceiver"; }
  std::uint64_t receive() override {
    const std::uint64_t got = SourceReceiver::receive();
    for (const Datagram& datagram : batch().datagrams) {
      frames_.clear();
      decoder_.push(datagram, frames_);
    }
    return got;
  }

 private:
  CsiReceiver decoder_{CsiReceiverOptions{}};
  std::vector<CsiFrame> frames_;
};

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) * 1e-6;
}

struct Run {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  double rate = 0;         // really sent, per second
  double cpu_seconds = 0;  // of the receiver
};

using Payloads = std::vector<std::vector<std::byte>>;

Run run(Receiver& receiver, double rate, const Payloads& payloads) {
  while (receiver.receive() > 0) {  // what is left of the last run
  }
  Run result;
  const double cpu_before = cpu_seconds();
  UdpFlood flood(
      {.port = receiver.port(), .rate = rate, .seconds = kSecondsPerRate, .payloads = &payloads});
  std::uint64_t got = 0;
  do {
    got = receiver.receive();
    result.received += got;
  } while (got > 0 || !flood.finished());
  // The datagrams that came between the last read and the end.
  while ((got = receiver.receive()) > 0) {
    result.received += got;
  }
  result.cpu_seconds = cpu_seconds() - cpu_before;
  result.sent = flood.sent();
  result.rate = flood.rate();
  return result;
}

// The highest rate without loss.
double measure(Receiver& receiver, const Payloads& payloads) {
  constexpr std::array kRates = {50e3, 100e3, 150e3, 200e3, 250e3, 300e3, 400e3, 500e3, 700e3, 1e6};
  double best = 0;
  for (const double rate : kRates) {
    Run result = run(receiver, rate, payloads);
    if (result.received < result.sent) {
      result = run(receiver, rate, payloads);
    }
    const bool whole = result.received == result.sent;
    std::printf("%-28s asked %8.0f/s  sent %8.0f/s  lost %8llu  %6.0f ns CPU each\n",
                receiver.name(),
                rate,
                result.rate,
                static_cast<unsigned long long>(result.sent - result.received),  // NOLINT
                result.cpu_seconds * 1e9 / static_cast<double>(result.received));
    std::fflush(stdout);
    if (!whole) {
      break;
    }
    best = std::max(best, result.rate);
    if (result.rate < 0.9 * rate) {
      break;  // the sender can do no more
    }
  }
  return best;
}

Payloads read_payloads(const std::string& path) {
  Payloads payloads;
  auto source = PcapFileSource::open(path);
  DatagramBatch batch;
  while (source && !batch.ended && (*source)->read(batch, Duration(0))) {
    for (const Datagram& datagram : batch.datagrams) {
      payloads.emplace_back(datagram.payload.begin(), datagram.payload.end());
    }
  }
  return payloads;
}

int run_all(const std::string& recording) {
  const Payloads payloads = read_payloads(recording);
  if (payloads.empty()) {
    std::fprintf(stderr, "udp_bench: %s: no datagrams\n", recording.c_str());
    return 65;
  }
  std::vector<std::unique_ptr<Receiver>> receivers;
  receivers.push_back(std::make_unique<BareReceiver>());
  receivers.push_back(std::make_unique<SourceReceiver>());
  receivers.push_back(std::make_unique<FrameReceiver>());
  double baseline = 0;
  for (const auto& receiver : receivers) {
    const double best = measure(*receiver, payloads);
    baseline = baseline == 0 ? best : baseline;
    std::printf("%-28s %8.0f/s without loss, %.2f of the baseline\n",
                receiver->name(),
                best,
                best / baseline);
  }
  return 0;
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  return rayloc::bench::run_all(
      argc > 1 ? argv[1] : rayloc::test::data_path("/sites/meeting_room/calibration-ap1.pcap.gz"));
}
