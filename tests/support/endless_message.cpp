#include "tests/support/endless_message.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>

#include "capture/transport/file_descriptor.h"

namespace rayloc {
namespace {

constexpr char kCommand = 4;
constexpr char kMore = 1;
constexpr char kMoreLong = 3;

std::string greeting() {
  std::string bytes("\xff\0\0\0\0\0\0\0\x01\x7f\x03\0NULL", 16);
  bytes.resize(64, '\0');
  return bytes;
}

std::string ready(const std::string& type) {
  const std::string name = "Socket-Type";
  std::string body = "\x05READY";
  body += static_cast<char>(name.size());
  body += name + std::string(3, '\0') + static_cast<char>(type.size()) + type;
  return std::string{kCommand, static_cast<char>(body.size())} + body;
}

std::string part(std::size_t bytes) {
  if (bytes < 256) {
    return std::string{kMore, static_cast<char>(bytes)} + std::string(bytes, 'x');
  }
  std::string head(1, kMoreLong);
  for (int shift = 56; shift >= 0; shift -= 8) {
    head += static_cast<char>(bytes >> static_cast<unsigned>(shift));
  }
  return head + std::string(bytes, 'x');
}

bool send_all(int fd, const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t now = send(fd, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (now <= 0) {
      return false;
    }
    sent += static_cast<std::size_t>(now);
  }
  return true;
}

// Waits until the peer has completed the handshake: earlier data is an error to the peer.
bool wait_for_ready(int fd) {
  std::string output;
  std::array<char, 512> buffer;
  while (output.find("READY") == std::string::npos) {
    const ssize_t got = recv(fd, buffer.data(), buffer.size(), 0);
    if (got <= 0) {
      return false;
    }
    output.append(buffer.data(), static_cast<std::size_t>(got));
  }
  return true;
}

}  // namespace

std::size_t send_endless_message(const std::string& endpoint,
                                 const std::string& type,
                                 std::size_t part_bytes,
                                 std::size_t most_bytes) {
  const FileDescriptor fd(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port =
      htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
  if (connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      !send_all(fd.get(), greeting() + ready(type)) || !wait_for_ready(fd.get())) {
    return 0;
  }
  std::string parts;
  while (parts.size() < 65536) {
    parts += part(part_bytes);
  }
  std::size_t sent = 0;
  while (sent < most_bytes && send_all(fd.get(), parts)) {
    sent += parts.size();
  }
  return sent;
}

}  // namespace rayloc
