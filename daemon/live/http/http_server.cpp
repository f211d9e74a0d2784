#include "daemon/live/http/http_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <list>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "capture/transport/file_descriptor.h"
#include "daemon/live/http/request_handler.h"

namespace rayloc {
namespace {

using Clock = std::chrono::steady_clock;
using PollEvents = decltype(pollfd::events);

constexpr std::string_view kEndOfHead = "\r\n\r\n";
// Delay before accept() is retried after it failed for lack of descriptors or memory.
constexpr std::chrono::milliseconds kAcceptPause{100};

}  // namespace

// Not in an unnamed namespace: a member of HttpServer::Impl.
struct HttpConnection {
  FileDescriptor socket;
  Clock::time_point since;  // time of the connection
  Clock::time_point deadline;
  std::string head;        // head being read
  std::string answer;      // answer being written
  std::size_t awaits = 0;  // bytes of a body, which follows `head`
  std::string body;
  std::size_t sent = 0;   // sent bytes of the answer
  bool finished = false;  // the answer is sent: further input of the client is discarded
  // The feed of a viewer.
  std::shared_ptr<EventFeed> events;  // null: none
  EventCursor cursor;
  Clock::time_point next_check;
  Clock::time_point next_word;  // time of the next write, a comment if there are no events

  bool writing() const { return !answer.empty() && !finished; }
};

namespace {

Expected<int> listen_at(const HttpServer::Options& options) {
  const std::string where = options.host + ":" + std::to_string(options.port);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(options.port);
  if (inet_pton(AF_INET, options.host.c_str(), &address.sin_addr) != 1) {
    return make_error(ErrorKind::kConfiguration, "http: " + where + " is no numeric address");
  }
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (fd < 0 || bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(fd, SOMAXCONN) != 0) {
    const int error = errno;
    close(fd);
    return make_error(
        ErrorKind::kUnavailable,
        "http: cannot listen at " + where + ": " + std::strerror(error) +
            (error == EADDRINUSE ? "; is another raylocd running? Set [http] listen, or "
                                   "enabled = false"
                                 : ""));
  }
  return fd;
}

}  // namespace

class HttpServer::Impl {
 public:
  // `wake`: an eventfd.
  Impl(int listener, int wake, const Options& options, std::map<std::string, HttpRoute> routes)
      : limits_(options.limits),
        listener_(listener),
        wake_(wake),
        handler_(std::move(routes), options.token, options.front),
        on_round_(options.on_round) {
    fcntl(listener, F_SETFL, fcntl(listener, F_GETFL) | O_NONBLOCK);
    sockaddr_in bound{};
    socklen_t size = sizeof bound;
    getsockname(listener, reinterpret_cast<sockaddr*>(&bound), &size);
    port_ = ntohs(bound.sin_port);
  }

  ~Impl() { stop(); }

  void start() {
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    eventfd_write(wake_.get(), 1);
    if (thread_.joinable()) {
      thread_.join();
    }
  }
  std::uint16_t port() const { return port_; }
  void set_routes(std::map<std::string, HttpRoute> routes) {
    handler_.set_routes(std::move(routes));
  }

  HttpCounters counters() const {
    const std::lock_guard lock(mutex_);
    return counters_;
  }

 private:
  void run();
  void accept_all();
  bool has_waiting_client() const;
  bool make_room(bool is_input_read);
  // Returns false when the connection is over.
  bool advance(HttpConnection& connection, PollEvents events);
  bool read_request(HttpConnection& connection);
  void receive_head(HttpConnection& connection);
  bool receive_viewer(HttpConnection& connection);
  bool write_answer(HttpConnection& connection);
  void set_answer(HttpConnection& connection, HttpAnswer answer);
  void make_viewer(HttpConnection& connection, HttpAnswer answer);
  void show_viewers(Clock::time_point now);
  std::size_t viewers() const;
  bool has_memory_for(std::size_t body) const;
  void close_late(Clock::time_point now);
  template <typename Change>
  void count(Change change) {
    const std::lock_guard lock(mutex_);
    change(counters_);
  }

  const HttpLimits limits_;
  const FileDescriptor listener_;
  const FileDescriptor wake_;
  RequestHandler handler_;
  const std::function<void()> on_round_;
  std::uint16_t port_ = 0;
  std::list<HttpConnection> connections_;  // oldest first; used by the thread only
  mutable std::mutex mutex_;
  HttpCounters counters_;            // guarded by mutex_
  Clock::time_point accepts_again_;  // no client is accepted until then; used by the thread only
  std::thread thread_;
};

void HttpServer::Impl::run() {
  constexpr int kIdleMs = 200;
  while (true) {
    if (on_round_) {
      on_round_();
    }
    const bool paused = Clock::now() < accepts_again_;
    std::vector<pollfd> waiting{{wake_.get(), POLLIN, 0},
                                {paused ? -1 : listener_.get(), POLLIN, 0}};
    for (const HttpConnection& connection : connections_) {
      const int reading = connection.events || !connection.writing() ? POLLIN : 0;
      const int writing = connection.writing() ? POLLOUT : 0;
      waiting.push_back({connection.socket.get(), static_cast<PollEvents>(reading | writing), 0});
    }
    // Deadlines and viewers are checked ten times a second while there are connections.
    poll(waiting.data(), waiting.size(), connections_.empty() && !paused ? kIdleMs : 100);
    if (waiting[0].revents != 0) {
      return;
    }
    std::size_t i = 2;
    for (auto connection = connections_.begin(); connection != connections_.end(); ++i) {
      const PollEvents events = waiting[i].revents;
      if (events == 0 || advance(*connection, events)) {
        ++connection;
        continue;
      }
      if (connection->events) {
        count([](HttpCounters& counters) { ++counters.viewers_left; });
      }
      connection = connections_.erase(connection);
    }
    if (waiting[1].revents != 0) {
      accept_all();
    }
    show_viewers(Clock::now());
    close_late(Clock::now());
    count([this](HttpCounters& counters) { counters.viewers = viewers(); });
  }
}

void HttpServer::Impl::accept_all() {
  for (bool is_input_read = true; has_waiting_client(); is_input_read = false) {
    if (!make_room(is_input_read)) {
      // New connections are read first; if that frees no place, accepting pauses.
      accepts_again_ = is_input_read ? Clock::now() + kAcceptPause : accepts_again_;
      return;
    }
    const int fd = accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) {
      // Waiting clients keep waiting, and poll() would report them again at once.
      const bool lacks = errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM;
      accepts_again_ = lacks ? Clock::now() + kAcceptPause : accepts_again_;
      return;
    }
    const Clock::time_point now = Clock::now();
    connections_.push_back({FileDescriptor(fd),
                            now,
                            now + limits_.time,
                            {},
                            {},
                            0,
                            {},
                            0,
                            false,
                            nullptr,
                            {},
                            {},
                            {}});
  }
}

bool HttpServer::Impl::has_waiting_client() const {
  pollfd listener{listener_.get(), POLLIN, 0};
  return poll(&listener, 1, 0) > 0;
}

// `is_input_read`: of all current clients. Returns false while no connection may be closed.
bool HttpServer::Impl::make_room(bool is_input_read) {
  if (connections_.size() < limits_.connections) {
    return true;
  }
  const auto first = [this](auto that) {
    return std::find_if(connections_.begin(), connections_.end(), that);
  };
  auto victim = first([](const HttpConnection& one) { return one.finished; });
  if (victim == connections_.end() && is_input_read) {
    const Clock::time_point begun = Clock::now() - limits_.chance;
    victim = first([&](const HttpConnection& one) { return !one.events && one.since <= begun; });
  }
  if (victim == connections_.end()) {
    return false;
  }
  connections_.erase(victim);
  count([](HttpCounters& counters) { ++counters.displaced; });
  return true;
}

bool HttpServer::Impl::advance(HttpConnection& connection, PollEvents events) {
  if (connection.events && (events & ~POLLOUT) != 0 && !receive_viewer(connection)) {
    return false;
  }
  if ((events & POLLOUT) != 0) {
    return write_answer(connection);
  }
  return connection.events || read_request(connection);
}

// A viewer sends no further requests; only the end of its connection matters.
bool HttpServer::Impl::receive_viewer(HttpConnection& connection) {
  std::array<char, 4096> buffer;
  const ssize_t got = recv(connection.socket.get(), buffer.data(), buffer.size(), 0);
  return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

bool HttpServer::Impl::read_request(HttpConnection& connection) {
  std::array<char, 16384> buffer;
  const ssize_t got = recv(connection.socket.get(), buffer.data(), buffer.size(), 0);
  if (got <= 0) {
    return got < 0 && (errno == EAGAIN || errno == EINTR);
  }
  if (connection.finished) {
    return true;
  }
  std::string& into = connection.awaits > 0 ? connection.body : connection.head;
  into.append(buffer.data(), static_cast<std::size_t>(got));
  if (connection.awaits == 0) {
    receive_head(connection);
  }
  if (connection.awaits > 0 && connection.body.size() >= connection.awaits) {
    connection.body.resize(connection.awaits);
    connection.awaits = 0;
    set_answer(connection, handler_.answer(connection.head, &connection.body));
    connection.body.clear();
    connection.body.shrink_to_fit();
  }
  return !connection.writing() || write_answer(connection);
}

// Answers a complete request; otherwise it awaits a body, or the rest of the head.
void HttpServer::Impl::receive_head(HttpConnection& connection) {
  const std::size_t end = connection.head.find(kEndOfHead);
  if (end == std::string::npos && connection.head.size() <= limits_.head_bytes) {
    return;
  }
  if (end == std::string::npos || end > limits_.head_bytes) {
    return set_answer(connection, handler_.refusal(431, "Request Header Fields Too Large"));
  }
  std::string body = connection.head.substr(end + kEndOfHead.size());
  connection.head.resize(end + kEndOfHead.size());
  HttpAnswer answer = handler_.answer(connection.head);
  if (answer.awaits > 0 && !has_memory_for(answer.awaits)) {
    answer = handler_.refusal(503, "Too Many Uploads", "Retry-After: 5\r\n");
  }
  if (answer.awaits > 0) {
    connection.awaits = answer.awaits;
    connection.body = std::move(body);
    connection.deadline = Clock::now() + limits_.body_time;
    return;
  }
  if (answer.events && viewers() >= limits_.viewers) {
    answer = handler_.refusal(503, "Too Many Viewers", "Retry-After: 5\r\n");
    count([](HttpCounters& counters) { ++counters.viewers_refused; });
  }
  set_answer(connection, std::move(answer));
}

void HttpServer::Impl::set_answer(HttpConnection& connection, HttpAnswer answer) {
  count([&](HttpCounters& counters) { ++counters.requests[answer.status]; });
  if (answer.events) {
    return make_viewer(connection, std::move(answer));
  }
  connection.answer = std::move(answer.bytes);
  connection.deadline = Clock::now() + limits_.time;
}

void HttpServer::Impl::make_viewer(HttpConnection& connection, HttpAnswer answer) {
  connection.answer = std::move(answer.bytes);
  connection.events = std::move(answer.events);
  connection.cursor.last_event_id = std::move(answer.last_event_id);
  connection.next_check = Clock::now();
  connection.next_word = Clock::now() + limits_.event_silence;
  connection.deadline = Clock::now() + limits_.event_patience;
  // The kernel's buffer for a viewer that has disconnected is also bounded, in bytes and in time.
  constexpr int kQueuedBytes = 128 * 1024;
  const auto patience = static_cast<unsigned>(limits_.event_patience.count());
  setsockopt(connection.socket.get(), SOL_SOCKET, SO_SNDBUF, &kQueuedBytes, sizeof kQueuedBytes);
  setsockopt(connection.socket.get(), IPPROTO_TCP, TCP_USER_TIMEOUT, &patience, sizeof patience);
}

// Queries the feed for each viewer that has read all data sent to it.
void HttpServer::Impl::show_viewers(Clock::time_point now) {
  for (auto connection = connections_.begin(); connection != connections_.end();) {
    if (!connection->events || connection->writing() || now < connection->next_check) {
      ++connection;
      continue;
    }
    connection->next_check = now + limits_.event_interval;
    EventBatch batch = connection->events->take(connection->cursor);
    count([&](HttpCounters& counters) {
      counters.messages_coalesced += batch.coalesced;
      counters.events += batch.text.empty() ? 0U : 1U;
    });
    connection->answer = std::move(batch.text);
    if (connection->answer.empty() && now >= connection->next_word) {
      connection->answer = ":\n\n";  // a comment: browsers ignore it
    }
    if (!connection->answer.empty()) {
      connection->next_word = now + limits_.event_silence;
    }
    connection->deadline = now + limits_.event_patience;
    if (connection->answer.empty() || write_answer(*connection)) {
      ++connection;
      continue;
    }
    count([](HttpCounters& counters) { ++counters.viewers_left; });
    connection = connections_.erase(connection);
  }
}

std::size_t HttpServer::Impl::viewers() const {
  return static_cast<std::size_t>(
      std::count_if(connections_.begin(), connections_.end(), [](const HttpConnection& one) {
        return one.events;
      }));
}

// In addition to the bodies that other connections await.
bool HttpServer::Impl::has_memory_for(std::size_t body) const {
  std::size_t sum = body;
  for (const HttpConnection& one : connections_) {
    sum += one.awaits > limits_.small_body ? one.awaits : 0;
  }
  return body <= limits_.small_body || sum <= limits_.awaited_bytes;
}

bool HttpServer::Impl::write_answer(HttpConnection& connection) {
  const ssize_t sent = send(connection.socket.get(),
                            connection.answer.data() + connection.sent,
                            connection.answer.size() - connection.sent,
                            MSG_NOSIGNAL);
  if (sent < 0) {
    return errno == EAGAIN || errno == EINTR;
  }
  connection.sent += static_cast<std::size_t>(sent);
  if (connection.events && sent > 0) {
    connection.deadline = Clock::now() + limits_.event_patience;
  }
  if (connection.sent < connection.answer.size()) {
    return true;
  }
  if (connection.events) {
    connection.answer.clear();
    connection.sent = 0;
    return true;
  }
  // Closing with unread input would reset the connection and discard the answer. So the sending
  // side is shut down, and input is read until the client closes or the time is up.
  shutdown(connection.socket.get(), SHUT_WR);
  connection.finished = true;
  return true;
}

void HttpServer::Impl::close_late(Clock::time_point now) {
  for (auto connection = connections_.begin(); connection != connections_.end();) {
    const bool viewer = connection->events != nullptr;
    if (now < connection->deadline || (viewer && !connection->writing())) {
      ++connection;
      continue;
    }
    if (viewer) {
      count([](HttpCounters& counters) { ++counters.viewers_stuck; });
    } else if (!connection->finished) {
      count([](HttpCounters& counters) { ++counters.timed_out; });
    }
    connection = connections_.erase(connection);
  }
}

Expected<std::unique_ptr<HttpServer>> HttpServer::open(const Options& options,
                                                       std::map<std::string, HttpRoute> routes) {
  int listener = options.adopted_fd;
  if (listener < 0) {
    const Expected<int> opened = listen_at(options);
    RAYLOC_TRY(opened);
    listener = *opened;
  }
  const int wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake < 0) {
    const int error = errno;
    close(listener);
    return make_error(ErrorKind::kUnavailable,
                      std::string("http: no descriptor to be stopped by: ") + std::strerror(error));
  }
  return std::unique_ptr<HttpServer>(
      new HttpServer(std::make_unique<Impl>(listener, wake, options, std::move(routes))));
}

HttpServer::HttpServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HttpServer::~HttpServer() = default;

void HttpServer::start() { impl_->start(); }
void HttpServer::stop() { impl_->stop(); }
std::uint16_t HttpServer::port() const { return impl_->port(); }
void HttpServer::set_routes(std::map<std::string, HttpRoute> routes) {
  impl_->set_routes(std::move(routes));
}

HttpCounters HttpServer::counters() const { return impl_->counters(); }

}  // namespace rayloc
