#include "tests/bench/crowd/crowd_sender.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "capture/decode/axcsi_decoder.h"

namespace rayloc::bench {
namespace {

// The offset of the transmitter's address in a datagram.
std::size_t address_in(std::span<const std::byte> payload) {
  const auto header = read_axcsi_header(payload);
  if (!header) {
    throw std::runtime_error("a datagram is no AX-CSI");
  }
  const auto* const address = reinterpret_cast<const std::byte*>(header->transmitter.octets.data());
  const auto head = payload.first(kAxcsiHeaderBytes);
  const auto found =
      std::search(head.begin(), head.end(), address, address + header->transmitter.octets.size());
  if (found == head.end()) {
    throw std::runtime_error("a datagram does not hold its transmitter's address");
  }
  return static_cast<std::size_t>(found - head.begin());
}

int socket_to(std::uint16_t port) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (fd < 0 || connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("no socket to send from");
  }
  return fd;
}

}  // namespace

MacAddress crowd_address(int number) {
  return {{0x02,
           0x52,
           0x4c,
           0x01,
           static_cast<std::uint8_t>(number / 256),
           static_cast<std::uint8_t>(number % 256)}};
}

CrowdSender::CrowdSender(Crowd crowd) : crowd_(std::move(crowd)) {
  plan();
  thread_ = std::thread([this] { run(); });
}

CrowdSender::~CrowdSender() {
  stopping_ = true;
  thread_.join();
}

void CrowdSender::plan() {
  for (const test::Recording& recording : crowd_.recordings) {
    if (recording.empty() || recording.back().time - recording.front().time <= crowd_.length) {
      throw std::runtime_error("a recording is shorter than what is to be sent");
    }
    address_at_.push_back(address_in(recording.front().payload));
  }
  const Timestamp begin = crowd_.recordings.front().front().time;
  const Duration spare = crowd_.recordings.front().back().time - begin - crowd_.length;
  for (int device = 0; device < crowd_.devices; ++device) {
    const Timestamp first = begin + spare * device / crowd_.devices;
    for (std::size_t ap = 0; ap < crowd_.recordings.size(); ++ap) {
      const test::Recording& recording = crowd_.recordings[ap];
      for (std::size_t i = 0; i < recording.size(); ++i) {
        const Duration after = recording[i].time - first;
        if (after >= Duration::zero() && after < crowd_.length) {
          events_.push_back({after,
                             static_cast<std::uint32_t>(i),
                             static_cast<std::uint16_t>(ap),
                             static_cast<std::uint16_t>(device)});
        }
      }
    }
  }
  std::stable_sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
    return a.after < b.after;
  });
}

void CrowdSender::run() {
  std::vector<int> sockets;
  for (const std::uint16_t port : crowd_.ports) {
    sockets.push_back(socket_to(port));
  }
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::byte> payload;
  for (const Event& event : events_) {
    if (stopping_) {
      break;
    }
    const auto due = begin + event.after;
    std::this_thread::sleep_until(due);
    const auto late = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::steady_clock::now() - due);
    latest_ms_ = std::max<std::int64_t>(latest_ms_, late.count());
    payload = crowd_.recordings[event.access_point][event.datagram].payload;
    std::memcpy(payload.data() + address_at_[event.access_point],
                crowd_address(crowd_.first + event.device).octets.data(),
                sizeof(MacAddress::octets));
    // A port without a reader is an error of the next call, which the sender ignores.
    static_cast<void>(::send(sockets[event.access_point], payload.data(), payload.size(), 0));
  }
  for (const int fd : sockets) {
    close(fd);
  }
  finished_ = true;
}

}  // namespace rayloc::bench
