#include "daemon/live/publish/socket/connection_guard.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <set>
#include <string_view>
#include <thread>
#include <utility>

#include <zmq.hpp>

#include "daemon/live/publish/socket/curve_keys.h"
#include "daemon/live/publish/socket/inbound_watch.h"

namespace rayloc {
namespace {

// The address and the vocabulary of ZAP: https://rfc.zeromq.org/spec/27
constexpr const char* kZapEndpoint = "inproc://zeromq.zap.01";
constexpr const char* kZapVersion = "1.0";
constexpr const char* kZapDomain = "raylocd";
constexpr std::size_t kZapFrames = 7;  // version, id, domain, address, identity, mechanism, key
constexpr const char* kStopEndpoint = "inproc://stop-guard";

// A connection that has not authenticated by then is closed.
constexpr int kHandshakeMs = 10'000;
constexpr int kHandshakeEvents = ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL |
                                 ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                                 ZMQ_EVENT_HANDSHAKE_FAILED_AUTH;
constexpr int kConnectionEvents = ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED;

using Frames = std::vector<zmq::message_t>;

// All available frames of one message; empty if none has arrived.
Frames receive(zmq::socket_t& socket) {
  Frames frames;
  do {
    zmq::message_t frame;
    if (!socket.recv(frame, zmq::recv_flags::dontwait)) {
      return {};
    }
    frames.push_back(std::move(frame));
  } while (frames.back().more());
  return frames;
}

// The descriptor on which the part arrived; -1 for parts that libzmq creates, as at the end of
// subscriptions when a connection breaks.
int connection_of(zmq::message_t& part) { return zmq_msg_get(part.handle(), ZMQ_SRCFD); }

std::string z85(const zmq::message_t& key) {
  std::array<char, 41> text{};
  zmq_z85_encode(text.data(), key.data<std::uint8_t>(), key.size());
  return text.data();
}

}  // namespace

// An event of a socket's monitor (zmq_socket_monitor(3)): the first frame of its messages.
struct MonitorEvent {
  std::uint16_t number = 0;
  std::int32_t value = 0;  // the descriptor in the connection events used here

  explicit MonitorEvent(const zmq::message_t& frame) {
    if (frame.size() >= sizeof number + sizeof value) {
      std::memcpy(&number, frame.data(), sizeof number);
      std::memcpy(&value, frame.data<char>() + sizeof number, sizeof value);
    }
  }
};

class ConnectionGuard::Impl {
 public:
  explicit Impl(Options options)
      : options_(std::move(options)),
        context_(2),  // one libzmq thread for each of our two sockets
        allowed_(options_.allow.begin(), options_.allow.end()),
        zap_(context_, zmq::socket_type::rep),
        stop_(context_, zmq::socket_type::pair),
        stopped_(context_, zmq::socket_type::pair) {
    zap_.set(zmq::sockopt::linger, 0);
    // libzmq accepts every client while no ZAP handler answers (ZMQ_ZAP_ENFORCE_DOMAIN is a draft
    // that Debian's lacks): so bound before any other socket, and until all are closed.
    zap_.bind(kZapEndpoint);
    stopped_.bind(kStopEndpoint);
    stop_.connect(kStopEndpoint);
    thread_ = std::thread([this] { run(); });
  }
  ~Impl() {
    zmq_send(stop_.handle(), "", 0, 0);
    thread_.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  zmq::context_t& context() { return context_; }

  void allow(const std::vector<std::string>& public_keys) {
    const std::lock_guard lock(mutex_);
    allowed_ = std::set<std::string>(public_keys.begin(), public_keys.end());
  }

  GuardCounters counters() const { return {admitted_, denied_, failed_, inbound_.cut_off()}; }

  void delivered(zmq::message_t& part) { inbound_.delivered(connection_of(part), part.size()); }
  void subscribed(zmq::message_t& part, bool more) {
    const std::string_view prefix(part.data<char>() + 1, part.size() - 1);
    inbound_.subscribed(connection_of(part), prefix, more);
  }

  void secure(zmq::socket_t& socket) {
    if (!options_.secret_key.empty()) {
      socket.set(zmq::sockopt::curve_server, true);
      socket.set(zmq::sockopt::curve_secretkey, options_.secret_key);
      socket.set(zmq::sockopt::zap_domain, kZapDomain);
    }
    socket.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
    const std::lock_guard lock(mutex_);
    const std::string endpoint = "inproc://monitor-" + std::to_string(++monitored_);
    if (zmq_socket_monitor(
            socket.handle(), endpoint.c_str(), kHandshakeEvents | kConnectionEvents) != 0) {
      throw zmq::error_t();
    }
    zmq::socket_t monitor(context_, zmq::socket_type::pair);
    monitor.set(zmq::sockopt::linger, 0);
    monitor.connect(endpoint);
    added_.push_back(std::move(monitor));
  }

 private:
  void run() {
    std::vector<zmq::socket_t> monitors;
    while (true) {
      if (options_.on_round) {
        options_.on_round();
      }
      {
        const std::lock_guard lock(mutex_);
        for (zmq::socket_t& monitor : added_) {
          monitors.push_back(std::move(monitor));
        }
        added_.clear();
      }
      std::vector<zmq::pollitem_t> items = {{stopped_.handle(), 0, ZMQ_POLLIN, 0},
                                            {zap_.handle(), 0, ZMQ_POLLIN, 0}};
      for (zmq::socket_t& monitor : monitors) {
        items.push_back({monitor.handle(), 0, ZMQ_POLLIN, 0});
      }
      try {
        zmq::poll(items, inbound_.empty() ? kPoll : kInboundPoll);
        if ((items[0].revents & ZMQ_POLLIN) != 0) {
          return;
        }
        answer();
        for (std::size_t i = 0; i < monitors.size(); ++i) {
          read_events(monitors[i], static_cast<int>(i));
        }
        inbound_.check(std::chrono::steady_clock::now());
      } catch (const zmq::error_t& error) {
        if (error.num() != EINTR) {
          throw;
        }
      }
    }
  }

  void read_events(zmq::socket_t& monitor, int socket) {
    for (Frames frames = receive(monitor); !frames.empty(); frames = receive(monitor)) {
      const MonitorEvent event(frames.front());
      switch (event.number) {
        case ZMQ_EVENT_ACCEPTED:
          inbound_.accepted(socket, event.value, std::chrono::steady_clock::now());
          break;
        case ZMQ_EVENT_DISCONNECTED:
          inbound_.gone(socket, event.value);
          break;
        default:
          ++failed_;
      }
    }
  }

  void answer() {
    const Frames request = receive(zap_);
    if (request.empty()) {
      return;
    }
    const bool known = request.size() == kZapFrames && request[0].to_string() == kZapVersion &&
                       request[5].to_string() == "CURVE" && request[6].size() == kCurveKeyBytes;
    const std::string key = known ? z85(request[6]) : std::string();
    const bool admitted = known && is_allowed(key);
    ++(admitted ? admitted_ : denied_);
    if (!admitted && options_.on_denied) {
      options_.on_denied(key, request.size() > 3 ? request[3].to_string() : std::string());
    }
    const std::array<std::string, 6> reply = {kZapVersion,
                                              request.size() > 1 ? request[1].to_string() : "",
                                              admitted ? "200" : "400",
                                              admitted ? "OK" : "not on the allow list",
                                              admitted ? key : "",
                                              ""};
    for (std::size_t i = 0; i < reply.size(); ++i) {
      const bool last = i + 1 == reply.size();
      zap_.send(zmq::message_t(reply.at(i)),
                last ? zmq::send_flags::none : zmq::send_flags::sndmore);
    }
  }

  bool is_allowed(const std::string& key) const {
    const std::lock_guard lock(mutex_);
    return allowed_.count(key) != 0;
  }

  // Maximum time until the monitor of a newly added socket is read.
  static constexpr std::chrono::milliseconds kPoll{100};
  // Maximum time for which a connection may send at full rate before it is checked.
  static constexpr std::chrono::milliseconds kInboundPoll{20};

  const Options options_;
  zmq::context_t context_;  // before all sockets, whose end its destructor awaits
  mutable std::mutex mutex_;
  std::set<std::string> allowed_;     // guarded by mutex_
  std::vector<zmq::socket_t> added_;  // guarded by mutex_; monitors that the thread takes over
  int monitored_ = 0;                 // guarded by mutex_
  std::atomic<std::uint64_t> admitted_ = 0;
  std::atomic<std::uint64_t> denied_ = 0;
  std::atomic<std::uint64_t> failed_ = 0;
  InboundWatch inbound_{inbound_limits()};
  zmq::socket_t zap_;      // used by the thread only once it runs
  zmq::socket_t stop_;     // the destructor's end
  zmq::socket_t stopped_;  // the thread's end
  std::thread thread_;
};

ConnectionGuard::ConnectionGuard(Options options)
    : impl_(std::make_unique<Impl>(std::move(options))) {}
ConnectionGuard::~ConnectionGuard() = default;

void ConnectionGuard::allow(const std::vector<std::string>& public_keys) {
  impl_->allow(public_keys);
}
GuardCounters ConnectionGuard::counters() const { return impl_->counters(); }
zmq::context_t& ConnectionGuard::context() { return impl_->context(); }
void ConnectionGuard::secure(zmq::socket_t& socket) { impl_->secure(socket); }
void ConnectionGuard::delivered(zmq::message_t& part) { impl_->delivered(part); }
void ConnectionGuard::subscribed(zmq::message_t& part, bool more) { impl_->subscribed(part, more); }
void ConnectionGuard::release(zmq::socket_t& socket) {
  zmq_socket_monitor(socket.handle(), nullptr, 0);
}

std::shared_ptr<ConnectionGuard> guard_or_open_door(std::shared_ptr<ConnectionGuard> guard) {
  return guard ? std::move(guard) : std::make_shared<ConnectionGuard>(ConnectionGuard::Options{});
}

}  // namespace rayloc
