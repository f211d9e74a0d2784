#include "tests/e2e/notify_socket.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "tests/e2e/process.h"

namespace rayloc::e2e {

NotifySocket::NotifySocket(const std::filesystem::path& folder)
    : path_(folder / "notify"), socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string text = path_.string();
  if (text.size() >= sizeof address.sun_path) {
    throw std::runtime_error("too long for a socket: " + text);
  }
  std::memcpy(address.sun_path, text.data(), text.size());
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("cannot bind " + text);
  }
}

NotifySocket::~NotifySocket() { close(socket_); }

const std::vector<std::string>& NotifySocket::lines() {
  std::array<char, 4096> buffer{};
  ssize_t got = 0;
  while ((got = recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0) {
    std::istringstream message(std::string(buffer.data(), static_cast<std::size_t>(got)));
    for (std::string line; std::getline(message, line);) {
      lines_.push_back(line);
    }
  }
  return lines_;
}

int NotifySocket::count(const std::string& line) {
  const std::vector<std::string>& all = lines();
  return static_cast<int>(std::count(all.begin(), all.end(), line));
}

bool NotifySocket::wait_for(const std::string& line, std::chrono::seconds patience, int wanted) {
  return eventually(patience, [&] { return count(line) >= wanted; });
}

}  // namespace rayloc::e2e
