// RequestHandler: converts the head of a request to the bytes of the answer. Thread safety: one
// thread.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "daemon/live/http/http_server.h"

namespace rayloc {

struct HttpAnswer {
  int status = 0;
  std::string bytes;  // status line, headers, body
  // Not null: the events of this feed follow `bytes`.
  std::shared_ptr<EventFeed> events = nullptr;
  std::string last_event_id = {};  // as the viewer states it
  // Not 0: the request is valid so far, and this many bytes of a body are to be read.
  std::size_t awaits = 0;
};

class RequestHandler {
 public:
  RequestHandler(std::map<std::string, HttpRoute> routes,
                 std::string token,
                 const HttpFront& front = {});
  ~RequestHandler();

  // Replaces the routes; from any thread.
  void set_routes(std::map<std::string, HttpRoute> routes);

  // `head`: everything up to the empty line, which ends it. `body`: null until it has been read.
  HttpAnswer answer(const std::string& head, const std::string* body = nullptr);
  // The answer to a request that is refused for reasons other than its content. `headers`:
  // additional ones, whole lines.
  HttpAnswer refusal(int status, const std::string& reason, const std::string& headers = "") const;

 private:
  class Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace rayloc
