#include "daemon/live/publish/socket/tcp_listener.h"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <linux/netlink.h>
#include <linux/seccomp.h>
#include <netinet/in.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "capture/transport/file_descriptor.h"
#include "daemon/live/publish/publisher.h"

namespace rayloc::tcp_listener_test {
namespace {

// As RestrictAddressFamilies= does without AF_NETLINK. Holds for the rest of the process.
bool deny_netlink() {
  std::array<sock_filter, 6> program = {{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_socket, 0, 3),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AF_NETLINK, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EAFNOSUPPORT),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  }};
  const sock_fprog filter = {.len = program.size(), .filter = program.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0 &&
         socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE) < 0 && errno == EAFNOSUPPORT;
}

// Binds each of them there, and ends with 0 when that works; with what is wrong on stderr.
[[noreturn]] void publish_without_netlink() {
  if (!deny_netlink()) {
    std::fputs("the filter does not hold\n", stderr);
    std::_Exit(2);
  }
  for (const char* const endpoint : {"tcp://localhost:*", "tcp://127.0.0.1:*", "tcp://*:*"}) {
    PublisherOptions options;
    options.endpoint = endpoint;
    options.site = "office";
    options.epoch = random_epoch();
    if (const auto publisher = Publisher::bind(options); !publisher) {
      std::fprintf(stderr, "%s\n", publisher.error().message.c_str());
      std::_Exit(1);
    }
  }
  std::_Exit(0);
}

TEST(TcpListener, LocalhostIsTheLoopbackAddress) {
  const std::optional<int> opened = listen_on_tcp("tcp://localhost:*");
  ASSERT_TRUE(opened);
  const FileDescriptor fd(*opened);
  sockaddr_in bound{};
  socklen_t size = sizeof bound;
  ASSERT_EQ(getsockname(fd.get(), reinterpret_cast<sockaddr*>(&bound), &size), 0);
  EXPECT_EQ(bound.sin_family, AF_INET);
  EXPECT_EQ(bound.sin_addr.s_addr, htonl(INADDR_LOOPBACK));
}

TEST(TcpListener, OtherNamesAreNoAddresses) {
  for (const char* const endpoint :
       {"tcp://lo:5560", "tcp://localhost.example.org:5560", "tcp://:5560", "ipc:///run/x"}) {
    EXPECT_FALSE(listen_on_tcp(endpoint)) << endpoint;
  }
}

// libzmq 4.3.4 aborts when it may not ask the kernel for the interfaces of the machine.
TEST(TcpListenerDeathTest, NothingIsAskedOfTheKernelByNetlink) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(publish_without_netlink(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace rayloc::tcp_listener_test
