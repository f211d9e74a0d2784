#include "daemon/live/config/endpoint.h"

#include <string>

#include <gtest/gtest.h>

namespace rayloc::endpoint_test {
namespace {

TEST(ParseListen, TakesNumericAddresses) {
  const auto address = parse_listen("192.168.1.2:5501");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->host, "192.168.1.2");
  EXPECT_EQ(address->port, 5501);
  EXPECT_EQ(parse_listen(":5500")->host, "0.0.0.0");
  EXPECT_EQ(parse_listen("*:5500")->host, "0.0.0.0");
}

TEST(ParseListen, RefusesInvalidAddresses) {
  for (const char* text : {"",
                           "5500",
                           "1.2.3:5500",
                           "1.2.3.4:",
                           "1.2.3.4:-1",
                           "1.2.3.4:70000",
                           "1.2.3.4:55x",
                           "[::1]:5500"}) {
    EXPECT_FALSE(parse_listen(text)) << text;
  }
}

TEST(Field, ListenTakesLocalhostAndNamesIpv6) {
  EXPECT_EQ(parse_listen("localhost:5500")->host, "127.0.0.1");
  EXPECT_TRUE(same_port(*parse_listen("localhost:5500"), {"127.0.0.1", 5500}));
  for (const char* text : {"[::1]:8581", "[::]:8581", "::1:8581", "::1", "[fe80::1%eth0]:8581"}) {
    EXPECT_NE(listen_fault(text).find("IPv6"), std::string::npos) << text;
  }
  for (const char* text : {"", "8581", "lab:8581", "127.0.0.1", "127.0.0.1:99999"}) {
    EXPECT_EQ(listen_fault(text).find("IPv6"), std::string::npos) << text;
  }
}

TEST(SamePort, AnyAddressConflictsWithEachAddress) {
  EXPECT_TRUE(same_port({"0.0.0.0", 5500}, {"127.0.0.1", 5500}));
  EXPECT_FALSE(same_port({"127.0.0.1", 5500}, {"127.0.0.2", 5500}));
  EXPECT_FALSE(same_port({"0.0.0.0", 5500}, {"0.0.0.0", 5501}));
  EXPECT_FALSE(same_port({"0.0.0.0", 0}, {"0.0.0.0", 0})) << "0 takes a free port";
}

TEST(EndpointReach, RecognisesLoopback) {
  for (const char* text : {"tcp://127.0.0.1:5560",
                           "tcp://127.1.2.3:1",
                           "tcp://[::1]:5560",
                           "tcp://localhost:5560",
                           "tcp://127.0.0.1:*",
                           "ipc:///run/raylocd/p"}) {
    EXPECT_EQ(endpoint_reach(text), EndpointReach::kLoopback) << text;
  }
}

TEST(EndpointReach, ClassifiesOtherAddressesAsNetwork) {
  for (const char* text : {"tcp://*:5560",
                           "tcp://0.0.0.0:5560",
                           "tcp://[::]:5560",
                           "tcp://[fd00::7]:5560",
                           "tcp://128.0.0.1:5560"}) {
    EXPECT_EQ(endpoint_reach(text), EndpointReach::kNetwork) << text;
  }
}

// libzmq would look them up by AF_NETLINK, and abort where a sandbox denies that.
TEST(EndpointReach, NamesAreClassifiedAsNamed) {
  for (const char* text : {"tcp://lo:5560",
                           "tcp://eth0:*",
                           "tcp://raylocd.example.org:5560",
                           "tcp://127.0.0.1.example.org:5560",
                           "tcp://eth0;192.168.1.1:5560",
                           "tcp://[fe80::1%eth0]:5560"}) {
    EXPECT_EQ(endpoint_reach(text), EndpointReach::kNamed) << text;
  }
}

TEST(EndpointReach, RefusesOtherTransports) {
  for (const char* text : {"",
                           "tcp://",
                           "tcp://127.0.0.1",
                           "tcp://127.0.0.1:0",
                           "tcp://:5560",
                           "tcp://127.0.0.1:99999",
                           "inproc://x",
                           "ws://127.0.0.1:1",
                           "ipc://"}) {
    EXPECT_EQ(endpoint_reach(text), EndpointReach::kInvalid) << text;
  }
  EXPECT_EQ(endpoint_reach("ipc:///" + std::string(200, 'x')), EndpointReach::kInvalid);
}

}  // namespace
}  // namespace rayloc::endpoint_test
