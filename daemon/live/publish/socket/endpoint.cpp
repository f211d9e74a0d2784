#include "daemon/live/publish/socket/endpoint.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include <zmq.h>

namespace rayloc {
namespace {

constexpr std::string_view kTcpScheme = "tcp://";
constexpr std::string_view kIpc = "ipc://";
constexpr const char* kEndpointAdvice = "write tcp://ADDRESS:PORT or ipc://PATH";

}  // namespace

Expected<void> check_endpoint(const std::string& endpoint, ErrorKind kind) {
  const auto refuse = [&](const std::string& why) {
    return make_error(kind, "endpoint \"" + endpoint + "\": " + why + "; " + kEndpointAdvice);
  };
  if (endpoint.starts_with(kIpc)) {
    const std::size_t length = endpoint.size() - kIpc.size();
    if (length == 0) {
      return refuse("no path");
    }
    if (length >= sizeof(sockaddr_un::sun_path)) {
      return refuse("the path is longer than the " +
                    std::to_string(sizeof(sockaddr_un::sun_path) - 1) +
                    " bytes that a socket's may have");
    }
    return {};
  }
  if (!endpoint.starts_with(kTcpScheme)) {
    return refuse("unknown kind of address");
  }
  const std::size_t colon = endpoint.rfind(':');
  if (colon < kTcpScheme.size() || colon == kTcpScheme.size() || colon + 1 == endpoint.size()) {
    return refuse("an address and a port are needed");
  }
  return {};
}

bool is_tcp(const std::string& endpoint) { return endpoint.starts_with(kTcpScheme); }

bool ipc_in_use(const std::string& endpoint) {
  if (!endpoint.starts_with(kIpc)) {
    return false;
  }
  sockaddr_un address{};
  const std::string path = endpoint.substr(kIpc.size());
  if (path.size() >= sizeof(address.sun_path)) {
    return false;
  }
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) {
    return false;
  }
  const int result = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  // EAGAIN: a process listens and has more connections pending than it accepts.
  const bool in_use = result == 0 || errno == EAGAIN;
  ::close(probe);
  return in_use;
}

Error endpoint_error(const std::string& endpoint, const std::string& verb, int number) {
  std::string message = "cannot " + verb + " " + endpoint + ": " + zmq_strerror(number);
  switch (number) {
    case EADDRINUSE:
      message += "; is another raylocd running? Choose another endpoint or stop it";
      break;
    case EADDRNOTAVAIL:
    case ENODEV:
      message += "; no interface of this machine has that address";
      break;
    case EINVAL:
      return {ErrorKind::kConfiguration, message + "; " + kEndpointAdvice};
    default:
      break;
  }
  return {ErrorKind::kUnavailable, message};
}

}  // namespace rayloc
