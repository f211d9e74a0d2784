#include "daemon/live/publish/socket/bound_socket.h"

#include <cerrno>
#include <optional>

#include "daemon/live/publish/socket/endpoint.h"
#include "daemon/live/publish/socket/tcp_listener.h"

namespace rayloc {

Expected<std::string> bind_socket(zmq::socket_t& socket,
                                  const std::string& endpoint,
                                  int adopted_fd) {
  RAYLOC_TRY(check_endpoint(endpoint, ErrorKind::kConfiguration));
  if (adopted_fd < 0 && ipc_in_use(endpoint)) {
    return tl::make_unexpected(endpoint_error(endpoint, "bind", EADDRINUSE));
  }
  try {
    const std::optional<int> fd = adopted_fd >= 0 ? adopted_fd : listen_on_tcp(endpoint);
    if (!fd && is_tcp(endpoint)) {
      return make_error(ErrorKind::kConfiguration,
                        "endpoint \"" + endpoint +
                            "\": the address must be numeric, and so must the port; write "
                            "tcp://ADDRESS:PORT with an address that `ip address` lists");
    }
    if (fd && *fd < 0) {
      return tl::make_unexpected(endpoint_error(endpoint, "bind", errno));
    }
    if (fd) {
      socket.set(zmq::sockopt::use_fd, *fd);
    }
    socket.bind(endpoint);
    return socket.get(zmq::sockopt::last_endpoint);
  } catch (const zmq::error_t& error) {
    return tl::make_unexpected(endpoint_error(endpoint, "bind", error.num()));
  }
}

}  // namespace rayloc
