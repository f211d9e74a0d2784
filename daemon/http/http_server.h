// HttpServer: answers requests of people and monitoring on a thread of its own.
//
//   HttpServer::Options options{.listen = "127.0.0.1:8480"};
//   auto server = HttpServer::open(options, {{"/healthz", [] { return HttpReply{200, ...}; }}});
//   (*server)->start();
//
// One thread polls all connections, so a client that is slow to ask or to read costs a descriptor
// for the time of HttpLimits and delays nobody. One request a connection, exact paths only, bodies
// only where a route takes them. Parsing and the form of answers are cpp-httplib's.
//
// A route with an EventFeed answers with a stream of events that lasts. What waits for a viewer is
// one batch; the next is made when that one is out, of what is the latest then.
//
// Against pages of the web that talk to a loopback service through a name of theirs (DNS
// rebinding): `Host` must be a number, "localhost", of one of HttpFront::origins, or absent, unless
// a token is asked for.
//
// What changes something is asked for by POST, and not by a page of the web: browsers say `Origin`,
// which is refused, but for what the map itself controls, if it is ours: that of `Host`, one of
// HttpFront::origins, or what the browser calls "same-origin" itself (Sec-Fetch-Site, which no page
// can write).
//
// Thread safety: open(), start() and the destructor from one thread; counters() from any. Handlers
// are called on the server's thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "daemon/http/event_feed.h"
#include "daemon/http/http_front.h"
#include "daemon/http/http_limits.h"
#include "engine/base/expected.h"

namespace rayloc {

struct HttpReply {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  bool own_styles = false;  // a page that brings its styles along, and no script: a report
};

// "?speed=2&state=paused"; the keys of a question, decoded.
using HttpParameters = std::multimap<std::string, std::string>;

struct HttpRoute {
  std::function<HttpReply()> handler;
  bool open = false;                            // answered without the token: health and metrics
  std::shared_ptr<EventFeed> events = nullptr;  // instead of `handler`: a stream
  std::string method = "GET";                   // HEAD with it; or "POST": it changes something
  // Besides GET: by POST it changes something, for pages of this server as well. Every such request
  // has kControlHeader, which a page of the web can only send where we allowed it to: we never do.
  std::function<HttpReply(const HttpParameters&)> control = nullptr;
  // As `control`, with a body of `content_type`. Nothing of a body is kept before all else about
  // its request is found right.
  std::function<HttpReply(const HttpParameters&, const std::string& body)> receive = nullptr;
  std::string content_type = "application/json";
  std::size_t most_bytes = 0;  // of a body for `receive`
};
inline constexpr const char* kControlHeader = "X-RayLoc-Control";

struct HttpCounters {
  std::map<int, std::uint64_t> requests;  // by status of the answer
  std::uint64_t timed_out = 0;            // connections closed for being slow
  std::uint64_t displaced = 0;            // connections closed to make room for a newer one
  // Viewers: of streams of events.
  std::uint64_t viewers = 0;             // now
  std::uint64_t viewers_refused = 0;     // more than HttpLimits::viewers
  std::uint64_t viewers_left = 0;        // closed by themselves
  std::uint64_t viewers_stuck = 0;       // closed by us: they took nothing
  std::uint64_t events = 0;              // given to viewers, of all together
  std::uint64_t messages_coalesced = 0;  // EventBatch::coalesced, of all together
};

class HttpServer {
 public:
  struct Options {
    std::string host = "127.0.0.1";  // numeric IPv4
    std::uint16_t port = 0;          // 0: a free one
    int adopted_fd = -1;             // a listening socket instead (socket activation)
    // Asked for when not empty: "Authorization: Bearer TOKEN", or, for browsers, Basic with the
    // user "rayloc" and TOKEN as the password.
    std::string token = {};
    HttpLimits limits = {};
    HttpFront front = {};
    // Called on the server's thread each time that its loop comes round, several times a second.
    std::function<void()> on_round = {};
  };

  // `routes`: by path. kUnavailable when the address cannot be bound.
  static Expected<std::unique_ptr<HttpServer>> open(const Options& options,
                                                    std::map<std::string, HttpRoute> routes);
  ~HttpServer();

  void start();
  // Answers nobody any more; the counters stay. Done by the destructor as well.
  void stop();
  std::uint16_t port() const;
  HttpCounters counters() const;
  // What is answered from now on; from any thread. Streams that are open go on.
  void set_routes(std::map<std::string, HttpRoute> routes);

 private:
  class Impl;
  explicit HttpServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
