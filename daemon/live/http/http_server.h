// HttpServer: answers requests of people and monitoring on its own thread.
//
//   HttpServer::Options options{.listen = "127.0.0.1:8480"};
//   auto server = HttpServer::open(options, {{"/healthz", [] { return HttpReply{200, ...}; }}});
//   (*server)->start();
//
// One thread polls all connections, so a client that sends or reads slowly costs a descriptor for
// the time of HttpLimits and delays no other client. One request a connection, exact paths only,
// bodies only if a route accepts them. cpp-httplib parses requests and formats answers.
//
// A route with an EventFeed answers with a continuous stream of events. One batch waits for a
// viewer; the next one is made from the latest messages when that one has been sent.
//
// Against web pages that reach a loopback service through their own name (DNS rebinding): `Host`
// must be a number, "localhost", that of an entry of HttpFront::origins, or absent, unless a token
// is required.
//
// Changes of state need POST, and are refused to web pages: a request with `Origin` is refused,
// except for controls of the map itself if it is ours: that of `Host`, one of
// HttpFront::origins, or one that the browser marks "same-origin" itself (Sec-Fetch-Site, which
// no page can write).
//
// Thread safety: open(), start() and the destructor from one thread; counters() from any. Handlers
// are called on the server's thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "daemon/live/http/event_feed.h"
#include "daemon/live/http/http_front.h"
#include "daemon/live/http/http_limits.h"
#include "engine/base/expected.h"

namespace rayloc {

struct HttpReply {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  bool own_styles = false;  // a page with its own styles and no script: a report
};

// "?speed=2&state=paused"; the decoded keys of a query.
using HttpParameters = std::multimap<std::string, std::string>;

struct HttpRoute {
  std::function<HttpReply()> handler;
  bool open = false;                            // answered without the token: health and metrics
  std::shared_ptr<EventFeed> events = nullptr;  // a stream instead of `handler`
  std::string method = "GET";                   // includes HEAD; or "POST": it changes state
  // Besides GET: a POST that changes state, also for pages of this server. Each such request has
  // kControlHeader, which a web page can send only with our permission: we never give it.
  std::function<HttpReply(const HttpParameters&)> control = nullptr;
  // As `control`, with a body of `content_type`. No part of a body is stored before all other
  // checks of its request have passed.
  std::function<HttpReply(const HttpParameters&, const std::string& body)> receive = nullptr;
  std::string content_type = "application/json";
  std::size_t most_bytes = 0;  // maximum size of a body for `receive`
  // Path whose route answers in place of this one, by the parameters; empty, or no such route: none
  // does.
  std::function<std::string(const HttpParameters&)> alias = nullptr;
};
inline constexpr const char* kControlHeader = "X-RayLoc-Control";

struct HttpCounters {
  std::map<int, std::uint64_t> requests;  // requests by status of the answer
  std::uint64_t timed_out = 0;            // connections closed for being slow
  std::uint64_t displaced = 0;            // connections closed to make room for a newer one
  // Viewers of streams of events.
  std::uint64_t viewers = 0;             // current number
  std::uint64_t viewers_refused = 0;     // viewers beyond HttpLimits::viewers
  std::uint64_t viewers_left = 0;        // viewers that disconnected
  std::uint64_t viewers_stuck = 0;       // closed by us: they read no data
  std::uint64_t events = 0;              // events sent to all viewers
  std::uint64_t messages_coalesced = 0;  // sum of EventBatch::coalesced over all viewers
};

class HttpServer {
 public:
  struct Options {
    std::string host = "127.0.0.1";  // numeric IPv4
    std::uint16_t port = 0;          // 0: any free port
    int adopted_fd = -1;             // a listening socket instead (socket activation)
    // Required if not empty: "Authorization: Bearer TOKEN", or, for browsers, Basic with the user
    // "rayloc" and TOKEN as the password.
    std::string token = {};
    HttpLimits limits = {};
    HttpFront front = {};
    // Called on the server's thread in each iteration of its loop, several times a second.
    std::function<void()> on_round = {};
  };

  // `routes`: by path. kUnavailable if the address cannot be bound.
  static Expected<std::unique_ptr<HttpServer>> open(const Options& options,
                                                    std::map<std::string, HttpRoute> routes);
  ~HttpServer();

  void start();
  // Ends all service; the counters remain. Called by the destructor as well.
  void stop();
  std::uint16_t port() const;
  HttpCounters counters() const;
  // Replaces the routes; from any thread. Open streams continue.
  void set_routes(std::map<std::string, HttpRoute> routes);

 private:
  class Impl;
  explicit HttpServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
