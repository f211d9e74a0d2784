#include "daemon/live/publish/late_subscriber.h"

#include <algorithm>
#include <utility>

#include <zmq.hpp>

#include "daemon/live/publish/socket/curve_client.h"
#include "daemon/live/publish/socket/endpoint.h"
#include "daemon/messages/topic.h"
#include "rayloc/v1/envelope.pb.h"
#include "rayloc/v1/snapshot.pb.h"

namespace rayloc {
namespace {

constexpr int kHighWaterMark = 100'000;
// Interval at which a wait checks for the arrival of the snapshot.
constexpr std::chrono::milliseconds kJoinPollInterval{50};

}  // namespace

// The socket on which the snapshot is requested.
class LateSubscriber::Question {
 public:
  Question(const std::vector<std::string>& prefixes, const std::optional<CurveClientKeys>& curve)
      : socket_(context_, zmq::socket_type::dealer) {
    v1::SnapshotRequest request;
    for (const std::string& prefix : prefixes) {
      request.add_prefixes(prefix);
    }
    // Heartbeats show when the messages in the snapshot have passed.
    request.add_prefixes(kHeartbeatTopics);
    request_ = request.SerializeAsString();
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::ipv6, true);
    socket_.set(zmq::sockopt::reconnect_ivl, 100);
    socket_.set(zmq::sockopt::reconnect_ivl_max, 1000);
    use_curve(curve, socket_);
  }
  void connect(const std::string& endpoint) { socket_.connect(endpoint); }
  void ask() { (void)socket_.send(zmq::buffer(request_), zmq::send_flags::dontwait); }
  // Returns the bytes of a reply if one has arrived.
  std::optional<std::string> answer() {
    zmq::message_t reply;
    return socket_.recv(reply, zmq::recv_flags::dontwait) ? std::optional(reply.to_string())
                                                          : std::nullopt;
  }

 private:
  zmq::context_t context_;
  zmq::socket_t socket_;
  std::string request_;
};

LateSubscriber::LateSubscriber(Subscriber subscriber,
                               std::unique_ptr<Question> question,
                               std::vector<std::string> prefixes,
                               std::chrono::milliseconds patience)
    : subscriber_(std::move(subscriber)),
      question_(std::move(question)),
      prefixes_(std::move(prefixes)),
      patience_(patience) {}
LateSubscriber::~LateSubscriber() = default;
LateSubscriber::LateSubscriber(LateSubscriber&&) noexcept = default;
LateSubscriber& LateSubscriber::operator=(LateSubscriber&&) noexcept = default;

Expected<LateSubscriber> LateSubscriber::join(const std::string& endpoint,
                                              const std::string& snapshot,
                                              const std::vector<std::string>& prefixes,
                                              std::chrono::milliseconds patience,
                                              const std::optional<CurveClientKeys>& curve) {
  std::vector<std::string> subscriptions = prefixes;
  subscriptions.emplace_back(kHeartbeatTopics);
  Expected<Subscriber> subscriber =
      Subscriber::connect(endpoint, subscriptions, kHighWaterMark, curve);
  RAYLOC_TRY(subscriber);
  RAYLOC_TRY(check_endpoint(snapshot, ErrorKind::kUsage));
  auto question = std::make_unique<Question>(prefixes, curve);
  try {
    question->connect(snapshot);
  } catch (const zmq::error_t& error) {
    Error problem = endpoint_error(snapshot, "connect to", error.num());
    problem.kind = ErrorKind::kUsage;
    return tl::make_unexpected(std::move(problem));
  }
  LateSubscriber late(std::move(*subscriber), std::move(question), prefixes, patience);
  RAYLOC_TRY(late.wait_for_snapshot(endpoint, snapshot));
  return late;
}

Expected<void> LateSubscriber::wait_for_snapshot(const std::string& endpoint,
                                                 const std::string& snapshot) {
  const auto begun = Clock::now();
  while (joining_) {
    if (Clock::now() - asked_.value_or(begun) > patience_) {
      return make_error(ErrorKind::kUnavailable,
                        asked_ ? "no snapshot from " + snapshot + "; is raylocd running there?"
                               : "no heartbeat of a raylocd at " + endpoint);
    }
    step(Clock::now() + kJoinPollInterval);
  }
  return {};
}

std::optional<PublishedMessage> LateSubscriber::receive(std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  bool waits = true;
  while (ready_.empty() && waits) {
    waits = step(deadline) && Clock::now() < deadline;
    if (joining_ && asked_ && Clock::now() - *asked_ > patience_) {
      go_live();  // proceed without the snapshot rather than not at all
    }
  }
  if (ready_.empty()) {
    return std::nullopt;
  }
  PublishedMessage message = std::move(ready_.front());
  ready_.pop_front();
  return message;
}

// Handles the next input, until `deadline` or for a while. False if a signal ended the wait.
bool LateSubscriber::step(Clock::time_point deadline) {
  const auto left = std::max(std::chrono::milliseconds(0),
                             std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()));
  const auto wait = joining_ ? std::min(left, kJoinPollInterval) : left;
  const auto until = Clock::now() + wait;
  std::optional<PublishedMessage> message = subscriber_.receive(wait);
  const bool interrupted = !message && Clock::now() + std::chrono::milliseconds(1) < until;
  if (message) {
    take(std::move(*message));
  }
  while (joining_) {
    const std::optional<std::string> reply = question_->answer();
    if (!reply) {
      break;
    }
    take_snapshot(*reply);
  }
  return !interrupted;
}

void LateSubscriber::take(PublishedMessage message) {
  v1::Envelope envelope;
  if (!envelope.ParseFromString(message.payload)) {
    ready_.push_back(std::move(message));  // the receiver detects that it is no message
    return;
  }
  if (epoch_ && envelope.epoch() != *epoch_) {
    begin_anew();
  }
  epoch_ = envelope.epoch();
  if (!joining_) {
    accept(std::move(message), envelope.sequence());
    return;
  }
  const bool is_heartbeat = message.topic.starts_with(kHeartbeatTopics);
  early_.push_back({std::move(message), envelope.sequence()});
  if (is_heartbeat) {
    question_->ask();
    asked_ = asked_.value_or(Clock::now());
  }
}

// Another epoch is a restarted daemon: all of its messages are new.
void LateSubscriber::begin_anew() {
  go_live();  // the ended daemon will send no snapshot
  in_snapshot_.clear();
  joining_ = true;
}

// A snapshot of an ended daemon is discarded.
void LateSubscriber::take_snapshot(const std::string& bytes) {
  v1::SnapshotReply reply;
  if (!reply.ParseFromString(bytes) || reply.topics_size() != reply.envelopes_size() ||
      reply.epoch() != epoch_) {
    return;
  }
  for (int i = 0; i < reply.topics_size(); ++i) {
    in_snapshot_[reply.topics(i)] = reply.envelopes(i).sequence();
    if (wanted(reply.topics(i))) {
      ready_.push_back({reply.topics(i), reply.envelopes(i).SerializeAsString(), true});
    }
  }
  go_live();
}

void LateSubscriber::go_live() {
  joining_ = false;
  asked_.reset();
  std::deque<Early> early = std::move(early_);
  early_.clear();
  for (Early& each : early) {
    accept(std::move(each.message), each.sequence);
  }
}

void LateSubscriber::accept(PublishedMessage message, std::uint64_t sequence) {
  if (const auto known = in_snapshot_.find(message.topic); known != in_snapshot_.end()) {
    if (sequence <= known->second) {
      return;
    }
    if (message.topic.starts_with(kHeartbeatTopics)) {
      in_snapshot_.clear();  // sent after the snapshot was made, as are all later ones
    }
  }
  if (wanted(message.topic)) {
    ready_.push_back(std::move(message));
  }
}

bool LateSubscriber::wanted(const std::string& topic) const {
  return std::any_of(prefixes_.begin(), prefixes_.end(), [&](const std::string& prefix) {
    return topic.starts_with(prefix);
  });
}

}  // namespace rayloc
