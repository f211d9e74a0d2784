#include "daemon/live/publish/subscriber.h"

#include <cerrno>
#include <utility>

#include <zmq.hpp>

#include "daemon/live/publish/socket/curve_client.h"
#include "daemon/live/publish/socket/endpoint.h"

namespace rayloc {

class Subscriber::Impl {
 public:
  Impl(int high_water_mark, const std::optional<CurveClientKeys>& curve)
      : socket_(context_, zmq::socket_type::sub) {
    socket_.set(zmq::sockopt::rcvhwm, high_water_mark);
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::ipv6, true);
    // At most a second until a restarted daemon is reconnected.
    socket_.set(zmq::sockopt::reconnect_ivl, 100);
    socket_.set(zmq::sockopt::reconnect_ivl_max, 1000);
    use_curve(curve, socket_);
  }

  void connect(const std::string& endpoint, const std::vector<std::string>& prefixes) {
    for (const std::string& prefix : prefixes) {
      socket_.set(zmq::sockopt::subscribe, prefix);
    }
    socket_.connect(endpoint);
  }

  std::optional<PublishedMessage> receive(std::chrono::milliseconds timeout) {
    try {
      socket_.set(zmq::sockopt::rcvtimeo, static_cast<int>(timeout.count()));
      while (true) {
        zmq::message_t frame;
        if (!socket_.recv(frame)) {
          return std::nullopt;
        }
        PublishedMessage message{frame.to_string(), {}, false};
        std::size_t frames = 1;
        while (frame.more()) {  // the further frames of a message arrive with the first
          (void)socket_.recv(frame);
          ++frames;
          message.payload = frame.to_string();
        }
        if (frames == 2) {
          return message;
        }
        ++malformed_;
      }
    } catch (const zmq::error_t& error) {
      if (error.num() != EINTR) {
        throw;
      }
      return std::nullopt;
    }
  }

  std::uint64_t malformed() const { return malformed_; }

 private:
  zmq::context_t context_;
  zmq::socket_t socket_;
  std::uint64_t malformed_ = 0;
};

Expected<Subscriber> Subscriber::connect(const std::string& endpoint,
                                         const std::vector<std::string>& prefixes,
                                         int high_water_mark,
                                         const std::optional<CurveClientKeys>& curve) {
  RAYLOC_TRY(check_endpoint(endpoint, ErrorKind::kUsage));
  auto impl = std::make_unique<Impl>(high_water_mark, curve);
  try {
    impl->connect(endpoint, prefixes);
  } catch (const zmq::error_t& error) {
    Error problem = endpoint_error(endpoint, "connect to", error.num());
    problem.kind = ErrorKind::kUsage;
    return tl::make_unexpected(problem);
  }
  return Subscriber(std::move(impl));
}

Subscriber::Subscriber(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Subscriber::~Subscriber() = default;
Subscriber::Subscriber(Subscriber&&) noexcept = default;
Subscriber& Subscriber::operator=(Subscriber&&) noexcept = default;

std::optional<PublishedMessage> Subscriber::receive(std::chrono::milliseconds timeout) {
  return impl_->receive(timeout);
}

std::uint64_t Subscriber::malformed() const { return impl_->malformed(); }

}  // namespace rayloc
