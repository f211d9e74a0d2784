#include "daemon/live/http/http_query.h"

#include <charconv>
#include <cstdint>

#include <httplib.h>

namespace rayloc {
namespace {

constexpr std::time_t kPatienceSeconds = 5;

Expected<HttpResult> ask(const HttpQuery& query, const std::string& path, bool post) {
  const std::size_t colon = query.address.rfind(':');
  std::uint16_t port = 0;
  const char* const end = query.address.data() + query.address.size();
  if (colon == std::string::npos || colon == 0 ||
      std::from_chars(query.address.data() + colon + 1, end, port).ptr != end || port == 0) {
    return make_error(
        ErrorKind::kUsage,
        "'" + query.address + "' is no HOST:PORT; write, for example, 127.0.0.1:8480");
  }
  httplib::Client client(query.address.substr(0, colon), port);
  client.set_connection_timeout(kPatienceSeconds);
  client.set_read_timeout(kPatienceSeconds);
  if (!query.token.empty()) {
    client.set_bearer_token_auth(query.token.c_str());
  }
  const httplib::Result result = post ? client.Post(path.c_str()) : client.Get(path.c_str());
  if (!result) {
    return make_error(ErrorKind::kUnavailable,
                      "no answer from http://" + query.address + path +
                          "; is raylocd running there, with [http] enabled?");
  }
  if (result->status == 401) {
    return make_error(ErrorKind::kUnavailable,
                      "http://" + query.address + path +
                          " asks for a token; give the file that [http] token_file names with "
                          "--token-file");
  }
  return HttpResult{result->status, result->body};
}

}  // namespace

Expected<HttpResult> http_get(const HttpQuery& query, const std::string& path) {
  return ask(query, path, false);
}

Expected<HttpResult> http_post(const HttpQuery& query, const std::string& path) {
  return ask(query, path, true);
}

}  // namespace rayloc
