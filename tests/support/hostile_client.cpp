#include "tests/support/hostile_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace rayloc {
namespace {

const std::string kLocal = "ipc://";

int connected(int family, const sockaddr* address, socklen_t size) {
  const int fd = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  // Without a connection nothing can be sent; the test detects this by the missing counts.
  (void)::connect(fd, address, size);
  return fd;
}

int connected_to(const std::string& endpoint) {
  if (endpoint.rfind(kLocal, 0) == 0) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    endpoint.copy(address.sun_path, sizeof address.sun_path - 1, kLocal.size());
    return connected(AF_UNIX, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port =
      htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
  return connected(AF_INET, reinterpret_cast<const sockaddr*>(&address), sizeof address);
}

std::string random_bytes(std::mt19937& random, std::size_t most) {
  std::string bytes(random() % (most + 1), '\0');
  for (char& byte : bytes) {
    byte = static_cast<char>(random());
  }
  return bytes;
}

// Sometimes truncated, and with up to three bytes changed.
std::string damaged(std::string bytes, std::mt19937& random) {
  if (random() % 3 == 0) {
    bytes.resize(random() % (bytes.size() + 1));
  }
  for (std::size_t changes = random() % 4; changes > 0 && !bytes.empty(); --changes) {
    bytes[random() % bytes.size()] = static_cast<char>(random());
  }
  return bytes;
}

template <typename T>
const T& one_of(const std::vector<T>& all, std::mt19937& random) {
  return all[random() % all.size()];
}

}  // namespace

HostileClient::HostileClient(const std::string& endpoint, const std::string& bytes)
    : fd_(connected_to(endpoint)) {
  (void)::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

HostileClient::HostileClient(HostileClient&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

HostileClient::~HostileClient() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
}

std::string hostile_handshake(std::mt19937& random) {
  if (random() % 4 == 0) {
    return random_bytes(random, 300);
  }
  static const std::vector<std::string> kMechanisms = {"CURVE", "NULL", "PLAIN", "GSSAPI", "????"};
  std::string bytes = std::string("\xff\0\0\0\0\0\0\0\x01\x7f\x03", 11) +
                      static_cast<char>(random() % 3) + one_of(kMechanisms, random);
  bytes.resize(32, '\0');
  bytes += static_cast<char>(random() % 2);
  bytes.resize(64, '\0');
  static const std::vector<std::string> kNames = {
      "HELLO", "INITIATE", "READY", "MESSAGE", "ERROR", "PING", "SUBSCRIBE", "x"};
  for (std::size_t commands = random() % 4; commands > 0; --commands) {
    const std::string& name = one_of(kNames, random);
    std::string body = std::string(1, static_cast<char>(name.size())) + name;
    body += name == "HELLO" ? std::string("\x01\0", 2) + std::string(72, '\0') : "";
    body += random_bytes(random, 250);
    body.resize(name == "HELLO" && random() % 2 == 0 ? 200 : body.size() % 256, '\x55');
    bytes += static_cast<char>(random() % 8 == 0 ? random() : 4U);
    bytes +=
        random() % 8 == 0 ? std::string(8, '\xff') : std::string(1, static_cast<char>(body.size()));
    bytes += body;
  }
  return damaged(std::move(bytes), random);
}

std::string hostile_request(std::mt19937& random) {
  if (random() % 4 == 0) {
    return random_bytes(random, 300);
  }
  static const std::vector<std::string> kMethods = {
      "GET", "POST", "PUT", "HEAD", "get", "\x7f", ""};
  static const std::vector<std::string> kPaths = {
      "/", "/metrics", "/api/v1/status", "/../../etc/passwd", "/%2e%2e/%00", "*", "http://x/", ""};
  static const std::vector<std::string> kVersions = {" HTTP/1.1", " HTTP/9.9", " HTTP/", ""};
  static const std::vector<std::string> kHeaders = {"Host: localhost\r\n",
                                                    "Content-Length: 99999999999999999999\r\n",
                                                    "Content-Length: -1\r\n",
                                                    "Transfer-Encoding: chunked\r\n",
                                                    "Range: bytes=9-1,--\r\n",
                                                    "Expect: 100-continue\r\n",
                                                    ": \r\n",
                                                    "\r\n"};
  std::string bytes =
      one_of(kMethods, random) + " " + one_of(kPaths, random) + one_of(kVersions, random) + "\r\n";
  for (std::size_t headers = random() % 5; headers > 0; --headers) {
    bytes += one_of(kHeaders, random);
  }
  return damaged(bytes + "\r\n" + random_bytes(random, 100), random);
}

}  // namespace rayloc
