// Messages without an end, to both of our sockets: bounded, counted, and their senders cut off.
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <zmq.hpp>

#include "capture/transport/file_descriptor.h"
#include "daemon/live/publish/late_subscriber.h"
#include "daemon/live/publish/socket/connection_guard.h"
#include "daemon/live/publish/socket/curve_keys.h"
#include "daemon/live/publish/socket/inbound_watch.h"
#include "tests/daemon/live/publish/guarded_daemon.h"
#include "tests/support/endless_message.h"
#include "tests/support/eventually.h"

namespace rayloc::field_endless_message_test {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 60s;
constexpr std::size_t kFlood = 200'000'000;  // bytes, at most

using test::GuardedDaemon;

std::uint64_t cut_off(const GuardedDaemon& daemon) {
  return daemon.guard().counters().clients_cut_off;
}

TEST(Field, EndlessMessagesAreCutOffAndCounted) {
  const GuardedDaemon daemon({});
  auto late = LateSubscriber::join(
      daemon.endpoint(), daemon.snapshots().endpoint(), {"v1/"}, test::patient(kPatience));
  ASSERT_TRUE(late) << late.error().message;
  std::uint64_t cut = 0;
  for (const std::size_t part_bytes : {0U, 60U, 4000U}) {
    const std::size_t to_publisher =
        send_endless_message(daemon.endpoint(), "SUB", part_bytes, kFlood);
    EXPECT_LT(to_publisher, kFlood);
    const std::size_t to_snapshots =
        send_endless_message(daemon.snapshots().endpoint(), "DEALER", part_bytes, kFlood);
    EXPECT_LT(to_snapshots, kFlood);
    cut += 2;
    EXPECT_TRUE(eventually(kPatience, [&] { return cut_off(daemon) >= cut; })) << part_bytes;
  }
  EXPECT_EQ(cut_off(daemon), cut);
  EXPECT_EQ(daemon.snapshots().counters().malformed, 0U) << "none came to its end";
  // Everybody else is served as before.
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(late->receive(test::patient(kPatience)));
  }
  EXPECT_TRUE(LateSubscriber::join(
      daemon.endpoint(), daemon.snapshots().endpoint(), {"v1/"}, test::patient(kPatience)));
}

// A message of 60,000 parts. libzmq sends it when it is whole, so it has an end, far away.
void send_many_parts(zmq::socket_t& socket) {
  constexpr int kParts = 60'000;
  const std::string part(200, 'x');
  for (int i = 0; i < kParts; ++i) {
    socket.send(zmq::message_t(part),
                i + 1 < kParts ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
}

TEST(Field, EndlessMessagesThroughCurveAreCutOffAsWell) {
  const CurveKeyPair server = make_curve_keys();
  const CurveKeyPair client = make_curve_keys();
  ConnectionGuard::Options access;
  access.secret_key = server.secret_key;
  access.allow = {client.public_key};
  const GuardedDaemon daemon(access);
  zmq::context_t context;
  std::uint64_t cut = 0;
  for (const auto& [endpoint, type] :
       {std::pair(daemon.endpoint(), zmq::socket_type::xsub),
        std::pair(daemon.snapshots().endpoint(), zmq::socket_type::dealer)}) {
    zmq::socket_t socket(context, type);
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::curve_serverkey, server.public_key);
    socket.set(zmq::sockopt::curve_publickey, client.public_key);
    socket.set(zmq::sockopt::curve_secretkey, client.secret_key);
    socket.connect(endpoint);
    send_many_parts(socket);
    ++cut;
    EXPECT_TRUE(eventually(kPatience, [&] { return cut_off(daemon) >= cut; })) << endpoint;
  }
  EXPECT_EQ(daemon.snapshots().counters().malformed, 0U);
  EXPECT_TRUE(LateSubscriber::join(daemon.endpoint(),
                                   daemon.snapshots().endpoint(),
                                   {"v1/"},
                                   test::patient(kPatience),
                                   CurveClientKeys{server.public_key, client}));
}

// Long transfers with an end: many requests, and many subscriptions at once.
TEST(Field, MessagesWithAnEndAreNeverCutOff) {
  const GuardedDaemon daemon({});
  zmq::context_t context;
  zmq::socket_t requests(context, zmq::socket_type::dealer);
  requests.set(zmq::sockopt::linger, 0);
  requests.connect(daemon.snapshots().endpoint());
  constexpr std::uint64_t kRequests = 20'000;
  for (std::uint64_t i = 0; i < kRequests; ++i) {
    requests.send(zmq::message_t(std::string(100, '\xff')), zmq::send_flags::none);
  }
  zmq::socket_t subscriber(context, zmq::socket_type::sub);
  subscriber.set(zmq::sockopt::linger, 0);
  constexpr std::uint64_t kPrefixes = 900;  // libzmq itself forgets some of more than 1,000
  for (std::uint64_t i = 0; i < kPrefixes; ++i) {
    subscriber.set(zmq::sockopt::subscribe, "v1/location/office/" + std::to_string(i) + "/");
  }
  subscriber.connect(daemon.endpoint());
  EXPECT_TRUE(
      eventually(kPatience, [&] { return daemon.snapshots().counters().malformed == kRequests; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return daemon.subscriptions() == kPrefixes; }));
  EXPECT_EQ(cut_off(daemon), 0U);
}

TEST(Field, SubscribersToTooMuchAreCutOff) {
  const GuardedDaemon daemon({});
  auto late = LateSubscriber::join(
      daemon.endpoint(), daemon.snapshots().endpoint(), {"v1/"}, test::patient(kPatience));
  ASSERT_TRUE(late) << late.error().message;
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::xsub);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::sndhwm, 0);
  socket.connect(daemon.endpoint());
  for (int i = 0; i < 50'000; ++i) {
    socket.send(zmq::message_t("\x01" + std::to_string(i)), zmq::send_flags::none);
    socket.send(zmq::message_t(std::string(1, '\0') + "never"), zmq::send_flags::none);
  }
  EXPECT_TRUE(eventually(kPatience, [&] { return cut_off(daemon) >= 1; }));
  socket.close();
  EXPECT_TRUE(eventually(kPatience, [&] { return daemon.subscriptions() < 10; }));
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(late->receive(test::patient(kPatience)));
  }
}

// A connection of which one end is watched.
class Connected {
 public:
  Connected() : listener_(::socket(AF_INET, SOCK_STREAM, 0)), ours_(dial()), theirs_(answer()) {}

  int watched() const { return theirs_.get(); }
  void send(std::size_t bytes) const {
    std::string text(bytes, 'x');
    EXPECT_EQ(::send(ours_.get(), text.data(), bytes, MSG_NOSIGNAL), static_cast<ssize_t>(bytes));
    EXPECT_EQ(::recv(watched(), text.data(), bytes, MSG_WAITALL), static_cast<ssize_t>(bytes));
  }
  // As it is when one end was shut down.
  bool ended() const {
    char byte = 0;
    return ::recv(ours_.get(), &byte, 1, MSG_DONTWAIT) == 0;
  }

 private:
  int dial() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    (void)::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), size);
    ::listen(listener_.get(), 1);
    ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size);
    const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
    EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&address), size), 0);
    return fd;
  }
  int answer() { return ::accept(listener_.get(), nullptr, nullptr); }

  FileDescriptor listener_;
  FileDescriptor ours_;
  FileDescriptor theirs_;
};

TEST(Field, InboundWatchCountsEndlessMessages) {
  const InboundWatch::Time begin{};
  InboundWatch watch({.unfinished_bytes = 1000,
                      .unfinished_bytes_in_all = 1500,
                      .signs_of_life_bytes = 10,
                      .connections = 3,
                      .subscriptions = 19});
  EXPECT_TRUE(watch.empty());
  const Connected one;
  const Connected two;
  const Connected three;
  const Connected four;
  // Messages that arrive before the event of their connection do not count either.
  three.send(4000);
  watch.delivered(three.watched(), 4000);
  for (const Connected* connection : {&one, &two, &three}) {
    watch.accepted(0, connection->watched(), begin);
  }
  // Bytes of whole messages do not count.
  one.send(2000);
  watch.delivered(one.watched(), 2000);
  two.send(5000);
  watch.delivered(two.watched(), 5000);
  watch.check(begin);
  EXPECT_EQ(watch.cut_off(), 0U);
  // Nor do signs of life; bytes that were not sent give no credit.
  one.send(1000);
  two.send(400);
  watch.check(begin + 50s);
  one.send(500);
  watch.check(begin + 50s);
  EXPECT_EQ(watch.cut_off(), 0U);
  // All together have too much: the worst goes.
  two.send(600);
  watch.check(begin + 50s);
  EXPECT_EQ(watch.cut_off(), 1U);
  EXPECT_TRUE(one.ended());
  EXPECT_FALSE(two.ended());
  // One alone has.
  two.send(500);
  watch.check(begin + 50s);
  EXPECT_EQ(watch.cut_off(), 2U);
  EXPECT_TRUE(two.ended());
  EXPECT_FALSE(three.ended());
  // An event of another socket is of an earlier connection with this descriptor.
  watch.gone(1, three.watched());
  EXPECT_FALSE(watch.empty());
  watch.gone(0, three.watched());
  EXPECT_TRUE(watch.empty());
  // Too many subscriptions do, also those before the event of the connection.
  const Connected eager;
  for (int i = 0; i < 20; ++i) {
    watch.subscribed(eager.watched(), std::to_string(i), true);
  }
  EXPECT_EQ(watch.cut_off(), 2U);
  watch.accepted(0, eager.watched(), begin);
  EXPECT_EQ(watch.cut_off(), 3U);
  EXPECT_TRUE(eager.ended());
  // One too many.
  for (const Connected* connection : {&one, &two, &three, &four}) {
    watch.accepted(0, connection->watched(), begin);
  }
  EXPECT_EQ(watch.cut_off(), 4U);
  EXPECT_TRUE(four.ended());
}

}  // namespace
}  // namespace rayloc::field_endless_message_test
