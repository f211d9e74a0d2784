#include "daemon/live/config/config_http.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/live/config/endpoint.h"
#include "daemon/live/http/http_front.h"

namespace rayloc {
namespace {

void check_listen(const TomlTable& root, const HttpConfig& http) {
  const std::optional<TomlTable> table = root.table("http");
  if (!table || !http.enabled || !table->is_string("listen")) {
    return;
  }
  if (http.host.empty()) {
    table->error_at("listen",
                    "'listen' " + listen_fault(table->string("listen").value_or("")) +
                        "; write, for example: listen = \"127.0.0.1:8480\"");
  } else if (!is_loopback(http.host) && http.token_file.empty() && !http.insecure) {
    table->error_at("listen",
                    "'listen' can be reached from the network, where everyone could read who is "
                    "where; write 127.0.0.1:PORT, or set token_file, or insecure = true if that "
                    "is meant");
  }
}

// Clients that write files must be authenticated; `insecure` lets every client read.
void check_edit(const TomlTable& root, const HttpConfig& http) {
  const std::optional<TomlTable> table = root.table("http");
  if (table && http.enabled && http.edit && !http.host.empty() && !is_loopback(http.host) &&
      http.token_file.empty()) {
    table->error_at("edit",
                    "'edit' would let everyone on the network write the files of the site; set "
                    "token_file, or listen = \"127.0.0.1:PORT\"");
  }
}

void check_front(const TomlTable& root, const HttpFront& front) {
  const std::optional<TomlTable> table = root.table("http");
  if (!table) {
    return;
  }
  if (!parse_base_path(front.base_path)) {
    table->error_at("base_path",
                    "'base_path' is '" + front.base_path +
                        "', which is no path of letters, digits and -._~; write, for example: "
                        "base_path = \"/rayloc\"");
  }
  const auto check = [&](const std::string& key,
                         const std::vector<std::string>& list,
                         bool (*is_good)(std::string_view),
                         const char* else_what) {
    const auto wrong = std::find_if_not(list.begin(), list.end(), is_good);
    if (wrong != list.end()) {
      table->error_at(key,
                      "'" + key + "': '" + *wrong +
                          "' is no origin; write, for example, https://home.example or "
                          "http://192.168.1.2:8123, without a path" +
                          else_what);
    }
  };
  check("origins", front.origins, is_origin, "");
  check("frame_ancestors", front.frame_ancestors, is_frame_ancestor, ", or self, or *");
}

}  // namespace

void check_http(const TomlTable& root, const HttpConfig& http) {
  check_listen(root, http);
  check_edit(root, http);
  check_front(root, http.front);
}

}  // namespace rayloc
