// Raw connections to an HTTP server on loopback, for tests that misbehave.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/patience.h"

namespace rayloc::testing {

class HttpClient {
 public:
  explicit HttpClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ =
        ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~HttpClient() { ::close(socket_); }
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  bool connected() const { return connected_; }
  // False when the server has closed.
  bool send(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }
  // Receives until the server closes its side or nothing arrives for `patience`, which is scaled as
  // every deadline is.
  std::string receive(std::chrono::milliseconds patience = std::chrono::seconds(10)) const {
    std::string text;
    std::array<char, 4096> buffer{};
    pollfd waiting{socket_, POLLIN, 0};
    const auto timeout = static_cast<int>(test::patient(patience).count());
    while (::poll(&waiting, 1, timeout) > 0) {
      const ssize_t got = ::recv(socket_, buffer.data(), buffer.size(), 0);
      if (got <= 0) {
        break;
      }
      text.append(buffer.data(), static_cast<std::size_t>(got));
    }
    return text;
  }

 private:
  int socket_;
  bool connected_ = false;
};

// The whole answer to one request.
inline std::string http_get(std::uint16_t port,
                            const std::string& path,
                            const std::string& more_headers = "") {
  const HttpClient client(port);
  client.send("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n" + more_headers + "\r\n");
  return client.receive();
}

inline std::string http_body(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}

// Checks the headers that keep browsers from interpreting the answer in another way.
inline void expect_policy(const std::string& answer) {
  const std::string head = answer.substr(0, answer.find("\r\n\r\n") + 2);
  for (const char* line :
       {"\r\nCache-Control: no-store\r\n",
        "\r\nX-Content-Type-Options: nosniff\r\n",
        "\r\nReferrer-Policy: no-referrer\r\n",
        "\r\nCross-Origin-Resource-Policy: same-origin\r\n",
        "\r\nContent-Security-Policy: default-src 'none'; script-src 'self'; "}) {
    EXPECT_NE(head.find(line), std::string::npos) << line << head;
  }
}

}  // namespace rayloc::testing
