#include <algorithm>
#include <stdexcept>
#include <utility>

#include "daemon/live/publish/late_subscriber.h"
#include "daemon/live/publish/socket/curve_keys.h"
#include "daemon/live/publish/subscriber.h"
#include "daemon/messages/gap_detector.h"
#include "daemon/messages/topic.h"
#include "deploy/clients/cpp/rayloc/client.h"

namespace rayloc::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kClientHighWaterMark = 100'000;

[[noreturn]] void raise(const Error& error) {
  if (error.kind == ErrorKind::kUsage) {
    throw std::invalid_argument(error.message);
  }
  throw std::runtime_error(error.message);
}

std::optional<CurveClientKeys> keys_of(const std::optional<Curve>& curve) {
  if (!curve) {
    return std::nullopt;
  }
  if (!is_curve_key(curve->server_key) || !is_curve_key(curve->secret_key)) {
    throw std::invalid_argument("a key of CURVE is 40 characters of Z85; see `rayloc keygen`");
  }
  return CurveClientKeys{curve->server_key,
                         {curve_public_key(curve->secret_key), curve->secret_key}};
}

}  // namespace

Curve Curve::read(const std::string& server_key, const std::string& secret_key) {
  Expected<std::string> server = read_curve_public(server_key);
  if (!server) {
    raise(server.error());
  }
  Expected<CurveKeyPair> own = read_curve_secret(secret_key);
  if (!own) {
    raise(own.error());
  }
  return {std::move(*server), std::move(own->secret_key)};
}

std::string Message::target() const {
  switch (envelope.body_case()) {
    case v1::Envelope::kLocation:
      return target_component(envelope.location().target());
    case v1::Envelope::kCompared:
      return target_component(envelope.compared().target());
    case v1::Envelope::kTrack:
      return target_component(envelope.track().target());
    case v1::Envelope::kZone:
      return target_component(envelope.zone().target());
    default:
      return {};
  }
}

class Subscriber::Impl {
 public:
  explicit Impl(Options options) : options_(std::move(options)) {
    // Heartbeats are always subscribed to: they reveal losses on silent topics, and show liveness.
    std::vector<std::string> topics = options_.topics;
    topics.emplace_back(kHeartbeatTopics);
    const std::optional<CurveClientKeys> curve = keys_of(options_.curve);
    if (options_.snapshot.empty()) {
      auto plain =
          rayloc::Subscriber::connect(options_.endpoint, topics, kClientHighWaterMark, curve);
      if (!plain) {
        raise(plain.error());
      }
      plain_.emplace(std::move(*plain));
    } else {
      auto late = LateSubscriber::join(
          options_.endpoint, options_.snapshot, topics, options_.patience, curve);
      if (!late) {
        raise(late.error());
      }
      late_.emplace(std::move(*late));
    }
  }

  std::optional<Message> receive(std::chrono::milliseconds timeout) {
    const auto deadline = Clock::now() + timeout;
    auto left = timeout;
    do {
      std::optional<PublishedMessage> arrived =
          late_ ? late_->receive(left) : plain_->receive(left);
      if (!arrived) {
        return std::nullopt;
      }
      Message message{std::move(arrived->topic), {}, arrived->from_snapshot};
      if (!message.envelope.ParseFromString(arrived->payload)) {
        ++malformed_;
      } else {
        observe(message);
        if (wanted(message)) {
          return message;
        }
      }
      left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    } while (left.count() > 0);
    return std::nullopt;
  }

  const GapDetector& gaps() const { return gaps_; }
  std::uint64_t malformed() const {
    return malformed_ + (plain_ ? plain_->malformed() : late_->malformed());
  }
  bool stale() const { return !received_ || Clock::now() - *received_ > options_.stale_after; }

 private:
  void observe(const Message& message) {
    gaps_.add(message.topic, message.envelope);
    if (message.from_snapshot) {
      return;  // does not count as a sign of life
    }
    if (message.envelope.has_heartbeat()) {
      received_ = Clock::now();
    } else if (message.envelope.has_goodbye()) {
      received_.reset();
    }
  }

  bool wanted(const Message& message) const {
    const bool of_topic =
        std::any_of(options_.topics.begin(), options_.topics.end(), [&](const std::string& prefix) {
          return message.topic.starts_with(prefix);
        });
    const std::string target = message.target();
    return of_topic && (options_.targets.empty() || target.empty() ||
                        std::find(options_.targets.begin(), options_.targets.end(), target) !=
                            options_.targets.end());
  }

  const Options options_;
  std::optional<rayloc::Subscriber> plain_;  // one of the two
  std::optional<LateSubscriber> late_;
  GapDetector gaps_;
  std::uint64_t malformed_ = 0;
  std::optional<Clock::time_point> received_;
};

Subscriber::Subscriber(Options options) : impl_(std::make_unique<Impl>(std::move(options))) {}
Subscriber::~Subscriber() = default;
Subscriber::Subscriber(Subscriber&&) noexcept = default;
Subscriber& Subscriber::operator=(Subscriber&&) noexcept = default;

std::optional<Message> Subscriber::receive(std::chrono::milliseconds timeout) {
  return impl_->receive(timeout);
}

std::uint64_t Subscriber::lost() const { return impl_->gaps().lost(); }
std::uint64_t Subscriber::restarts() const { return impl_->gaps().restarts(); }
std::uint64_t Subscriber::malformed() const { return impl_->malformed(); }
bool Subscriber::stale() const { return impl_->stale(); }

}  // namespace rayloc::client
