#include "daemon/live/publish/snapshot_server.h"

#include <atomic>
#include <cerrno>
#include <thread>
#include <utility>
#include <vector>

#include <zmq.hpp>

#include "daemon/live/publish/socket/bound_socket.h"
#include "daemon/live/publish/socket/connection_guard.h"
#include "daemon/live/publish/socket/connection_heartbeat.h"
#include "daemon/messages/last_messages.h"
#include "rayloc/v1/snapshot.pb.h"

namespace rayloc {
namespace {

constexpr std::int64_t kMaxRequestBytes = 65536;
constexpr int kMaxPrefixes = 256;
constexpr int kWaitingReplies = 16;  // per client; further ones are dropped
// Time for replies that wait for a client when the daemon ends.
constexpr int kLingerMs = 100;
constexpr int kPollMs = 100;

using Frames = std::vector<zmq::message_t>;

}  // namespace

class SnapshotServer::Impl {
 public:
  explicit Impl(Options options)
      : options_(std::move(options)),
        guard_(guard_or_open_door(options_.guard)),
        socket_(guard_->context(), zmq::socket_type::router) {
    socket_.set(zmq::sockopt::maxmsgsize, kMaxRequestBytes);
    socket_.set(zmq::sockopt::sndhwm, kWaitingReplies);
    socket_.set(zmq::sockopt::linger, kLingerMs);
    socket_.set(zmq::sockopt::ipv6, true);
    // A full queue is reported, not ignored.
    socket_.set(zmq::sockopt::router_mandatory, true);
    socket_.set(zmq::sockopt::rcvtimeo, kPollMs);
    socket_.set(zmq::sockopt::heartbeat_ivl, kHeartbeatIntervalMs);
    socket_.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeoutMs);
    guard_->secure(socket_);
  }
  ~Impl() {
    stopping_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
    ConnectionGuard::release(socket_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Expected<void> start() {
    const Expected<std::string> bound =
        bind_socket(socket_, options_.endpoint, options_.adopted_fd);
    RAYLOC_TRY(bound);
    endpoint_ = *bound;
    thread_ = std::thread([this] { run(); });
    return {};
  }

  const std::string& endpoint() const { return endpoint_; }
  SnapshotCounters counters() const { return {answered_, malformed_, dropped_}; }

 private:
  void run() {
    while (!stopping_) {
      if (options_.on_round) {
        options_.on_round();
      }
      try {
        if (Frames frames = receive(); !frames.empty()) {
          answer(std::move(frames));
        }
      } catch (const zmq::error_t& error) {
        if (error.num() == EHOSTUNREACH) {
          ++dropped_;  // the client has disconnected
        } else if (error.num() != EINTR) {
          throw;
        }
      }
    }
  }

  Frames receive() {
    Frames frames;
    do {
      zmq::message_t frame;
      if (!socket_.recv(frame)) {
        return {};
      }
      guard_->delivered(frame);
      frames.push_back(std::move(frame));
    } while (frames.back().more());
    return frames;
  }

  // Frames: the identity that ROUTER adds, the empty frame of a REQ socket, the request.
  void answer(Frames frames) {
    v1::SnapshotRequest request;
    const bool form = frames.size() == 2 || (frames.size() == 3 && frames[1].empty());
    if (!form ||
        !request.ParseFromArray(frames.back().data(), static_cast<int>(frames.back().size())) ||
        request.prefixes_size() > kMaxPrefixes) {
      ++malformed_;
      return;
    }
    frames.back() = zmq::message_t(reply_to(request));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const bool last = i + 1 == frames.size();
      const auto flags =
          zmq::send_flags::dontwait | (last ? zmq::send_flags::none : zmq::send_flags::sndmore);
      if (!socket_.send(frames[i], flags)) {
        ++dropped_;
        return;
      }
    }
    ++answered_;
  }

  std::string reply_to(const v1::SnapshotRequest& request) const {
    v1::SnapshotReply reply;
    reply.set_epoch(options_.epoch);
    const std::vector<std::string> prefixes(request.prefixes().begin(), request.prefixes().end());
    for (const auto& [topic, envelope] : options_.last->matching(prefixes)) {
      if (reply.add_envelopes()->ParseFromString(envelope)) {
        reply.add_topics(topic);
      } else {
        reply.mutable_envelopes()->RemoveLast();
      }
    }
    return reply.SerializeAsString();
  }

  const Options options_;
  std::shared_ptr<ConnectionGuard> guard_;  // its context outlives the socket
  zmq::socket_t socket_;
  std::string endpoint_;
  std::atomic<bool> stopping_ = false;
  std::atomic<std::uint64_t> answered_ = 0;
  std::atomic<std::uint64_t> malformed_ = 0;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::thread thread_;
};

Expected<std::unique_ptr<SnapshotServer>> SnapshotServer::open(const Options& options) {
  auto impl = std::make_unique<Impl>(options);
  RAYLOC_TRY(impl->start());
  return std::unique_ptr<SnapshotServer>(new SnapshotServer(std::move(impl)));
}

SnapshotServer::SnapshotServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SnapshotServer::~SnapshotServer() = default;

const std::string& SnapshotServer::endpoint() const { return impl_->endpoint(); }
SnapshotCounters SnapshotServer::counters() const { return impl_->counters(); }

}  // namespace rayloc
