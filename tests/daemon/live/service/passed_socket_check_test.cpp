#include "daemon/live/service/passed_socket_check.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/transport/file_descriptor.h"

namespace rayloc::passed_socket_check_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr bool kListening = true;

FileDescriptor bound(const char* address, int type, bool listening = false) {
  const bool v6 = std::strchr(address, ':') != nullptr;
  FileDescriptor fd(socket(v6 ? AF_INET6 : AF_INET, type | SOCK_CLOEXEC, 0));
  sockaddr_storage storage{};
  storage.ss_family = v6 ? AF_INET6 : AF_INET;
  char* const bytes = reinterpret_cast<char*>(&storage);
  const std::size_t at = v6 ? offsetof(sockaddr_in6, sin6_addr) : offsetof(sockaddr_in, sin_addr);
  EXPECT_EQ(inet_pton(storage.ss_family, address, bytes + at), 1);
  const socklen_t size = v6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
  EXPECT_EQ(bind(fd.get(), reinterpret_cast<const sockaddr*>(&storage), size), 0)
      << std::strerror(errno);
  EXPECT_TRUE(!listening || listen(fd.get(), 1) == 0);
  return fd;
}

SocketDemand http() {
  return {.unit = "raylocd-http.socket",
          .line = "ListenStream=127.0.0.1:8480",
          .precaution = "set token_file"};
}

SocketDemand udp() {
  return {.unit = "raylocd-source@ap1.socket",
          .line = "ListenDatagram=0.0.0.0:5500",
          .listening = false,
          .family = SocketDemand::Family::kInternet};
}

// "" when it is as demanded.
std::string complaint(const FileDescriptor& fd, const SocketDemand& demand) {
  const Expected<void> good = check_passed_socket(fd.get(), demand);
  EXPECT_TRUE(good || good.error().kind == ErrorKind::kConfiguration);
  return good ? "" : good.error().message;
}

TEST(PassedSocketCheck, ServesOthersOnlyWherePrecautionsWereTaken) {
  SocketDemand careful = http();
  careful.precaution.clear();
  for (const char* address : {"127.0.0.1", "127.1.2.3", "::1", "::ffff:127.0.0.1"}) {
    EXPECT_EQ(complaint(bound(address, SOCK_STREAM, kListening), http()), "") << address;
  }
  for (const char* address : {"0.0.0.0", "::", "::ffff:0.0.0.0"}) {
    const FileDescriptor fd = bound(address, SOCK_STREAM, kListening);
    EXPECT_THAT(complaint(fd, http()),
                AllOf(HasSubstr("raylocd-http.socket listens at "),
                      HasSubstr(std::strchr(address, ':') ? "]:" : "0.0.0.0:"),
                      HasSubstr("write ListenStream=127.0.0.1:8480 there, or set token_file")))
        << address;
    EXPECT_EQ(complaint(fd, careful), "") << address;
  }
  const FileDescriptor path(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  // No name is stated: the kernel chooses an abstract one.
  ASSERT_EQ(bind(path.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(sa_family_t)), 0);
  ASSERT_EQ(listen(path.get(), 1), 0);
  EXPECT_EQ(complaint(path, http()), "");
}

TEST(PassedSocketCheck, DescribesAnUnusableSocket) {
  EXPECT_EQ(complaint(bound("127.0.0.1", SOCK_STREAM), http()),
            "raylocd-http.socket passes an Internet stream socket that does not listen; it must "
            "have ListenStream=127.0.0.1:8480");
  EXPECT_THAT(complaint(bound("127.0.0.1", SOCK_DGRAM), http()),
              HasSubstr("passes an Internet datagram socket; it must have ListenStream="));
  EXPECT_EQ(complaint(bound("0.0.0.0", SOCK_DGRAM), udp()), "") << "datagrams come from elsewhere";
  EXPECT_THAT(complaint(bound("0.0.0.0", SOCK_STREAM, kListening), udp()),
              HasSubstr("raylocd-source@ap1.socket passes an Internet stream socket; it must have "
                        "ListenDatagram=0.0.0.0:5500"));
  const FileDescriptor path(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  EXPECT_THAT(complaint(path, udp()), HasSubstr("passes an AF_UNIX datagram socket; it must"));
  const FileDescriptor event(eventfd(0, EFD_CLOEXEC));
  EXPECT_THAT(complaint(event, udp()), HasSubstr("passes no socket; it must"));
}

}  // namespace
}  // namespace rayloc::passed_socket_check_test
