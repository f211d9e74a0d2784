#include "tests/bench/udp_sender.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

namespace rayloc::bench {
namespace {

constexpr std::size_t kBatch = 64;
// Datagrams that are due leave together.
constexpr std::chrono::microseconds kTick{200};

}  // namespace

UdpFlood::Result UdpFlood::send_all(const Flood& flood) {
  using Clock = std::chrono::steady_clock;
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(flood.port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    return {};
  }
  std::array<iovec, kBatch> vectors{};
  std::array<mmsghdr, kBatch> messages{};
  for (std::size_t i = 0; i < kBatch; ++i) {
    messages[i].msg_hdr.msg_iov = &vectors[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
  const auto total = static_cast<std::uint64_t>(flood.rate * flood.seconds);
  const auto begin = Clock::now();
  const auto elapsed = [begin] {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  std::uint64_t sent = 0;
  // A machine that cannot send so fast sends for as long, and less.
  while (sent < total && elapsed() < flood.seconds * 1.01) {
    const auto due = std::min(total, static_cast<std::uint64_t>(elapsed() * flood.rate));
    if (due == sent) {
      std::this_thread::sleep_for(kTick);
      continue;
    }
    const std::size_t count = std::min<std::uint64_t>(kBatch, due - sent);
    for (std::size_t i = 0; i < count; ++i) {
      const auto& payload = (*flood.payloads)[(sent + i) % flood.payloads->size()];
      vectors[i] = {.iov_base = const_cast<std::byte*>(payload.data()), .iov_len = payload.size()};
    }
    const int done = sendmmsg(fd, messages.data(), static_cast<unsigned>(count), 0);
    sent += done > 0 ? static_cast<std::uint64_t>(done) : 0;
  }
  return {sent, elapsed()};
}

UdpFlood::UdpFlood(const Flood& flood) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    return;
  }
  process_ = fork();
  if (process_ == 0) {
    const Result result = send_all(flood);
    const bool is_written = write(ends[1], &result, sizeof result) == sizeof result;
    _exit(is_written ? 0 : 1);
  }
  close(ends[1]);
  pipe_ = ends[0];
  fcntl(pipe_, F_SETFL, O_NONBLOCK);
}

UdpFlood::~UdpFlood() {
  close(pipe_);
  waitpid(process_, nullptr, 0);
}

bool UdpFlood::finished() {
  if (!finished_) {
    finished_ = read(pipe_, &result_, sizeof result_) == sizeof result_;
  }
  return finished_;
}

}  // namespace rayloc::bench
