#include "daemon/live/publish/publisher.h"

#include <cerrno>
#include <map>
#include <random>
#include <utility>

#include <zmq.hpp>

#include "daemon/live/publish/message_board.h"
#include "daemon/live/publish/sequence_book.h"
#include "daemon/live/publish/socket/bound_socket.h"
#include "daemon/live/publish/socket/connection_guard.h"
#include "daemon/live/publish/socket/connection_heartbeat.h"
#include "daemon/messages/last_messages.h"
#include "daemon/messages/proto_time.h"
#include "daemon/messages/topic.h"
#include "engine/base/check.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

// Subscribers may send only a prefix of a topic.
constexpr std::int64_t kMaxSubscriptionBytes = 4096;

template <typename Classes>
void fill_classes(const SequenceBook& book, bool all, Classes& classes) {
  classes.Clear();
  for (const auto& [prefix, state] : book.classes(all)) {
    v1::TopicClass& topic_class = *classes.Add();
    topic_class.set_prefix(prefix);
    topic_class.set_published(state.published);
    for (const auto& [topic, sequence] : state.last) {
      v1::TopicSequence& last = *topic_class.add_last_sequences();
      last.set_topic(topic);
      last.set_sequence(sequence);
    }
  }
}

}  // namespace

std::uint64_t random_epoch() {
  std::random_device entropy;
  std::uint64_t epoch = 0;
  while (epoch == 0) {
    epoch = (static_cast<std::uint64_t>(entropy()) << 32U) | entropy();
  }
  return epoch;
}

class Publisher::Impl {
 public:
  explicit Impl(const PublisherOptions& options)
      : options_(options),
        guard_(guard_or_open_door(options.guard)),
        socket_(guard_->context(), zmq::socket_type::xpub) {
    turn_to(options.site, options.board);
    socket_.set(zmq::sockopt::sndhwm, options.high_water_mark);
    socket_.set(zmq::sockopt::linger, static_cast<int>(options.linger.count()));
    socket_.set(zmq::sockopt::xpub_nodrop, true);
    socket_.set(zmq::sockopt::xpub_verboser, true);
    socket_.set(zmq::sockopt::heartbeat_ivl, kHeartbeatIntervalMs);
    socket_.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeoutMs);
    socket_.set(zmq::sockopt::maxmsgsize, kMaxSubscriptionBytes);
    socket_.set(zmq::sockopt::ipv6, true);
    guard_->secure(socket_);
  }
  ~Impl() { ConnectionGuard::release(socket_); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Expected<void> bind() {
    const Expected<std::string> bound =
        bind_socket(socket_, options_.endpoint, options_.adopted_fd);
    RAYLOC_TRY(bound);
    endpoint_ = *bound;
    return {};
  }

  void turn_to(const std::string& site, std::shared_ptr<MessageBoard> board) {
    site_ = site;
    board_ = std::move(board);
    book_ = &books_.try_emplace(site, options_.max_topics).first->second;
  }

  const std::string& site() const { return site_; }
  const std::string& endpoint() const { return endpoint_; }

  // The body of the next message; its previous content may be reused.
  v1::Envelope& envelope() { return envelope_; }

  void send(const std::string& topic, Timestamp sent, std::uint32_t coalesced) {
    envelope_.set_epoch(options_.epoch);
    envelope_.set_sequence(book_->next(topic));
    envelope_.set_coalesced(coalesced);
    *envelope_.mutable_sent() = to_proto(sent);
    zmq::message_t payload(envelope_.ByteSizeLong());
    RAYLOC_CHECK(envelope_.SerializeToArray(payload.data(), static_cast<int>(payload.size())));
    if (options_.last != nullptr && !envelope_.has_csi()) {
      options_.last->put(topic, payload.to_string());
    }
    if (board_ != nullptr) {
      board_->put(topic, envelope_, payload.to_string());
    }
    zmq::message_t prefix(topic.data(), topic.size());
    send_frame(prefix, zmq::send_flags::sndmore);
    send_frame(payload, zmq::send_flags::none);
    count_subscriptions();
  }

  PublishedCounters counters() {
    count_subscriptions();
    const GuardCounters guard = guard_->counters();
    std::uint64_t published = 0;
    for (const auto& [site, book] : books_) {
      published += book.published();
    }
    return {published,
            slow_episodes_,
            subscriptions_,
            guard.clients_denied,
            guard.handshakes_failed,
            guard.clients_cut_off};
  }

  template <typename Classes>
  void take_classes(bool all, Classes& classes) {
    fill_classes(*book_, all, classes);
    book_->forget_recent();
  }

  std::uint64_t epoch() const { return options_.epoch; }

 private:
  // Returns false if the queue of some subscriber is full.
  bool try_send(zmq::message_t& frame, zmq::send_flags flags) {
    while (true) {
      try {
        return socket_.send(frame, flags | zmq::send_flags::dontwait).has_value();
      } catch (const zmq::error_t& error) {
        if (error.num() != EINTR) {
          throw;
        }
      }
    }
  }

  void send_frame(zmq::message_t& frame, zmq::send_flags flags) {
    if (try_send(frame, flags)) {
      return;
    }
    ++slow_episodes_;
    socket_.set(zmq::sockopt::xpub_nodrop, false);
    RAYLOC_CHECK(try_send(frame, flags));
    socket_.set(zmq::sockopt::xpub_nodrop, true);
  }

  // Each subscription arrives as 1 and the prefix, each end of one as 0 and the prefix (also when
  // the connection breaks).
  void count_subscriptions() {
    zmq::message_t message;
    while (receive(message)) {
      guard_->delivered(message);
      if (message.empty()) {
        continue;
      }
      const std::byte first = *message.data<std::byte>();
      if (first == std::byte{1}) {
        ++subscriptions_;
        guard_->subscribed(message, true);
      } else if (first == std::byte{0} && subscriptions_ > 0) {
        --subscriptions_;
        guard_->subscribed(message, false);
      }
    }
  }

  bool receive(zmq::message_t& message) {
    while (true) {
      try {
        return socket_.recv(message, zmq::recv_flags::dontwait).has_value();
      } catch (const zmq::error_t& error) {
        if (error.num() != EINTR) {
          throw;
        }
      }
    }
  }

  PublisherOptions options_;
  std::shared_ptr<ConnectionGuard> guard_;  // its context outlives the socket
  zmq::socket_t socket_;
  std::map<std::string, SequenceBook> books_;  // by site
  std::string site_;                           // site of the messages being sent
  SequenceBook* book_ = nullptr;               // book of that site
  std::shared_ptr<MessageBoard> board_;        // board of that site; may be null
  std::string endpoint_;
  v1::Envelope envelope_;
  std::uint64_t slow_episodes_ = 0;
  std::uint64_t subscriptions_ = 0;
};

Expected<Publisher> Publisher::bind(const PublisherOptions& options) {
  if (options.site.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      "the site has no name, which topics need; set `name` in site.toml");
  }
  auto impl = std::make_unique<Impl>(options);
  RAYLOC_TRY(impl->bind());
  return Publisher(std::move(impl));
}

Publisher::Publisher(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Publisher::~Publisher() = default;
Publisher::Publisher(Publisher&&) noexcept = default;
Publisher& Publisher::operator=(Publisher&&) noexcept = default;

const std::string& Publisher::endpoint() const { return impl_->endpoint(); }

void Publisher::turn_to(const std::string& site, std::shared_ptr<MessageBoard> board) {
  impl_->turn_to(site, std::move(board));
}

void Publisher::publish(const v1::Location& location, Timestamp sent, std::uint32_t coalesced) {
  *impl_->envelope().mutable_location() = location;
  impl_->send(
      make_topic("location", impl_->site(), target_component(location.target())), sent, coalesced);
}

void Publisher::publish_compared(const v1::Location& location,
                                 Timestamp sent,
                                 std::uint32_t coalesced) {
  *impl_->envelope().mutable_compared() = location;
  impl_->send(compared_topic(
                  impl_->site(), location.quality().method(), target_component(location.target())),
              sent,
              coalesced);
}

void Publisher::publish(const v1::TrackEvent& event, Timestamp sent) {
  *impl_->envelope().mutable_track() = event;
  impl_->send(make_topic("track", impl_->site()), sent, 0);
}

void Publisher::publish(const v1::ZoneEvent& event, Timestamp sent) {
  *impl_->envelope().mutable_zone() = event;
  impl_->send(make_topic("zone", impl_->site(), event.zone()), sent, 0);
}

void Publisher::publish(const v1::SourceState& state, Timestamp sent) {
  *impl_->envelope().mutable_source() = state;
  impl_->send(make_topic("source", impl_->site(), state.access_point()), sent, 0);
}

void Publisher::publish(const v1::CsiFrame& frame, Timestamp sent) {
  *impl_->envelope().mutable_csi() = frame;
  impl_->send(make_topic("csi", impl_->site(), frame.ap()), sent, 0);
}

void Publisher::publish(v1::Heartbeat heartbeat, Timestamp sent) {
  const PublishedCounters counters = impl_->counters();
  heartbeat.set_epoch(impl_->epoch());
  heartbeat.set_message_version("v1");
  impl_->take_classes(false, *heartbeat.mutable_topic_classes());
  v1::PublisherCounters& own = *heartbeat.mutable_publisher();
  own.set_published(counters.published);
  own.set_slow_episodes(counters.slow_episodes);
  own.set_subscriptions(counters.subscriptions);
  own.set_clients_denied(counters.clients_denied);
  own.set_handshakes_failed(counters.handshakes_failed);
  own.set_clients_cut_off(counters.clients_cut_off);
  *impl_->envelope().mutable_heartbeat() = std::move(heartbeat);
  impl_->send(make_topic("heartbeat", impl_->site()), sent, 0);
}

void Publisher::publish(v1::Goodbye goodbye, Timestamp sent) {
  impl_->take_classes(true, *goodbye.mutable_topic_classes());
  *impl_->envelope().mutable_goodbye() = std::move(goodbye);
  impl_->send(make_topic("heartbeat", impl_->site()), sent, 0);
}

PublishedCounters Publisher::counters() { return impl_->counters(); }

}  // namespace rayloc
