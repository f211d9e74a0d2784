#include "tests/e2e/raw_figures.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <deque>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/live/publish/publisher.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/e2e/csi_reader.h"
#include "tests/support/eventually.h"

namespace rayloc::e2e {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::seconds kMeasured{1};
constexpr std::size_t kDatagramBytes = 566;  // of the bundled recordings: 128 tones of a core
constexpr int kValues = 3 * 128 * 2;         // of a frame: three cores, real and imaginary part
constexpr std::size_t kBatch = 64;
constexpr std::size_t kSubscribers = 5;

// Datagrams that are handed over by one call.
struct Batch {
  std::vector<std::array<char, kDatagramBytes>> bytes{kBatch};
  std::vector<iovec> parts{kBatch};
  std::vector<mmsghdr> messages{kBatch};

  Batch() {
    for (std::size_t i = 0; i < kBatch; ++i) {
      parts[i] = {bytes[i].data(), bytes[i].size()};
      messages[i].msg_hdr.msg_iov = &parts[i];
      messages[i].msg_hdr.msg_iovlen = 1;
    }
  }
};

// Datagrams received; `sent` counts those that `sender` sends meanwhile.
std::uint64_t receive_for_a_while(int receiver, int sender, std::atomic<std::uint64_t>& sent) {
  std::thread sending([&] {
    Batch batch;
    const auto end = Clock::now() + kMeasured;
    while (Clock::now() < end) {
      const int now = sendmmsg(sender, batch.messages.data(), kBatch, 0);
      sent += now > 0 ? static_cast<std::uint64_t>(now) : 0U;
    }
  });
  Batch batch;
  std::uint64_t received = 0;
  // Receives until nothing arrives within the socket's timeout.
  while (true) {
    const int now = recvmmsg(receiver, batch.messages.data(), kBatch, MSG_WAITFORONE, nullptr);
    if (now <= 0) {
      break;
    }
    received += static_cast<std::uint64_t>(now);
  }
  sending.join();
  return received;
}

bool all_counted(const std::deque<CsiReader>& readers, std::uint64_t published) {
  return std::all_of(readers.begin(), readers.end(), [&](const CsiReader& reader) {
    return reader.messages() + reader.lost() >= published;
  });
}

}  // namespace

void print_recvmmsg_alone() {
  const int receiver = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int sender = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int buffer = 8 << 20;
  setsockopt(receiver, SOL_SOCKET, SO_RCVBUFFORCE, &buffer, sizeof buffer);
  const timeval wait{0, 200'000};
  setsockopt(receiver, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(receiver, reinterpret_cast<sockaddr*>(&address), size), 0);
  getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &size);
  ASSERT_EQ(connect(sender, reinterpret_cast<sockaddr*>(&address), size), 0);
  std::atomic<std::uint64_t> sent = 0;
  const std::uint64_t received = receive_for_a_while(receiver, sender, sent);
  close(receiver);
  close(sender);
  std::printf("recvmmsg alone: %llu datagrams/s received of %llu/s sent\n",
              static_cast<unsigned long long>(received),      // NOLINT(google-runtime-int)
              static_cast<unsigned long long>(sent.load()));  // NOLINT(google-runtime-int)
}

void print_xpub_alone(int high_water_mark) {
  PublisherOptions options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.site = "alone";
  options.epoch = 1;
  options.high_water_mark = high_water_mark;
  auto publisher = Publisher::bind(options);
  ASSERT_TRUE(publisher) << publisher.error().message;
  std::deque<CsiReader> readers;
  for (std::size_t i = 0; i < kSubscribers; ++i) {
    readers.emplace_back(publisher->endpoint());
  }
  ASSERT_TRUE(eventually(kPatience,
                         [&] { return publisher->counters().subscriptions == 2 * kSubscribers; }));
  v1::CsiFrame frame;
  frame.set_ap("ap");
  for (int i = 0; i < kValues; ++i) {
    frame.add_csi(1.0F);
  }
  const auto begin = Clock::now();
  std::uint64_t published = 0;
  for (; Clock::now() < begin + kMeasured; ++published) {
    publisher->publish(frame, Timestamp{});
  }
  // Queued messages are still delivered; the goodbye reports the loss of the last ones.
  EXPECT_TRUE(eventually(kPatience, [&] {
    publisher->publish(v1::Goodbye{}, Timestamp{});
    return all_counted(readers, published);
  }));
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::uint64_t delivered = 0;
  std::uint64_t lost = 0;
  for (const CsiReader& reader : readers) {
    delivered += reader.messages();
    lost += reader.lost();
  }
  const std::uint64_t due = kSubscribers * published;
  EXPECT_EQ(delivered + lost, due) << "unaccounted";
  std::printf(
      "XPUB alone: %llu messages/s published to five, of queues of %d; %.0f/s delivered to all "
      "together in %.2f s, %llu of %llu lost because the publisher was faster\n",
      static_cast<unsigned long long>(published),  // NOLINT(google-runtime-int)
      high_water_mark,
      static_cast<double>(delivered) / seconds,
      seconds,
      static_cast<unsigned long long>(lost),  // NOLINT(google-runtime-int)
      static_cast<unsigned long long>(due));  // NOLINT(google-runtime-int)
}

}  // namespace rayloc::e2e
