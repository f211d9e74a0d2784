// Broker over libnats: only the files of this folder use libnats.
#include <nats/nats.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/nats/batch_requests.h"
#include "daemon/live/cluster/nats/link.h"
#include "daemon/live/cluster/nats/message.h"
#include "daemon/live/cluster/nats/module.h"
#include "daemon/live/cluster/nats/options.h"

namespace rayloc::nats {
namespace {

constexpr std::int64_t kMaxPayload = 1 << 20;  // bytes: the default of a server
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::int64_t kRememberIds = 60 * kNanosecondsPerSecond;
// Pause between connection attempts: each twice as long as its predecessor,
// so that many machines do not overload a server that has come back.
constexpr std::chrono::milliseconds kFirstPause{250};
constexpr std::chrono::milliseconds kLongestPause{2000};

using StreamInfo = std::unique_ptr<jsStreamInfo, Destroy<jsStreamInfo, jsStreamInfo_Destroy>>;
using Ack = std::unique_ptr<jsPubAck, Destroy<jsPubAck, jsPubAck_Destroy>>;

tl::unexpected<Error> away(const std::string& what) {
  return make_error(ErrorKind::kUnavailable, what + ": no server answers");
}

using Slots = std::list<std::shared_ptr<Slot>>;

class NatsBroker final : public Broker {
 public:
  ~NatsBroker() override;
  NatsBroker() = default;
  NatsBroker(const NatsBroker&) = delete;
  NatsBroker& operator=(const NatsBroker&) = delete;

  Expected<void> open(const BrokerOptions& options, const std::string& nkey);

  bool connected() const override { return linked() != nullptr; }
  std::uint64_t connections() const override { return connections_; }
  std::uint64_t failed_tries() const override { return failed_tries_; }
  std::size_t max_message() const override {
    const auto link = linked();
    const std::int64_t stated = link ? natsConnection_GetMaxPayload(link->connection()) : 0;
    return static_cast<std::size_t>(stated > 0 ? stated : kMaxPayload);
  }
  std::string refusal() const override {
    const std::lock_guard lock(mutex_);
    return refusal_;
  }
  Expected<std::unique_ptr<Subscription>> subscribe(const std::string& subject,
                                                    Handler handler) override {
    return listen(subject,
                  [handler = std::move(handler)](natsMsg* message) { handler(received(message)); });
  }
  Expected<void> publish(const std::string& subject, std::string_view data) override {
    const auto link = linked();
    const natsStatus status =
        link ? natsConnection_Publish(
                   link->connection(), subject.c_str(), data.data(), static_cast<int>(data.size()))
             : NATS_CONNECTION_DISCONNECTED;
    return status == NATS_OK ? Expected<void>() : tl::make_unexpected(error_of(subject, status));
  }
  Expected<std::unique_ptr<AckedPublisher>> acked_publisher(AckHandler handler) override;
  Expected<Published> publish_behind(const std::string& subject,
                                     std::string_view data,
                                     std::uint64_t last) override;
  Expected<std::string> ask(const std::string& subject, std::string_view data) override;
  Expected<void> ensure_stream(const StreamOptions& stream) override;
  Expected<StreamState> stream_state(const std::string& stream) override;
  Expected<std::optional<BrokerMessage>> get(const std::string& stream,
                                             std::uint64_t sequence) override;
  Expected<std::vector<BrokerMessage>> get_several(const std::string& stream,
                                                   const MessageRange& range) override;
  Expected<std::optional<BrokerMessage>> get_of_leader(const std::string& stream,
                                                       std::uint64_t sequence) override;
  Expected<std::optional<BrokerMessage>> last_of(const std::string& stream,
                                                 const std::string& subject) override;

  // Null while no server answers.
  std::shared_ptr<Link> linked() const {
    const std::lock_guard lock(mutex_);
    return link_ && link_->is_connected() ? link_ : nullptr;
  }
  void ignore(const std::shared_ptr<Slot>& slot);

 private:
  Expected<std::unique_ptr<Subscription>> listen(const std::string& subject, Slot::Take take);
  Expected<std::string> new_inbox() const;
  Expected<void> connect();
  void keep_linked();
  Link::Callbacks callbacks();
  void note_refusal(std::string words) {
    const std::lock_guard lock(mutex_);
    refusal_ = std::move(words);
  }

  BrokerOptions options_;
  Identity identity_{"", "_INBOX"};
  BatchRequests batches_;
  std::atomic<std::uint64_t> connections_{0};
  std::atomic<std::uint64_t> failed_tries_{0};
  std::mutex listening_;  // before mutex_; subscriptions of a link, and the current link
  Slots slots_;           // guarded by listening_
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<Link> link_;  // guarded by mutex_; null: none was made yet
  bool is_link_due_ = false;    // guarded by mutex_: missing or ended
  bool is_ending_ = false;      // guarded by mutex_
  std::string refusal_;         // guarded by mutex_
  std::thread keeper_;
  std::unique_ptr<Subscription> batch_replies_;
};

class NatsSubscription final : public Broker::Subscription {
 public:
  NatsSubscription(NatsBroker& broker, std::shared_ptr<Slot> slot)
      : broker_(broker), slot_(std::move(slot)) {}
  // REQUIRES: the broker is alive.
  ~NatsSubscription() override { broker_.ignore(slot_); }
  NatsSubscription(const NatsSubscription&) = delete;
  NatsSubscription& operator=(const NatsSubscription&) = delete;

 private:
  NatsBroker& broker_;
  const std::shared_ptr<Slot> slot_;
};

NatsBroker::~NatsBroker() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  if (keeper_.joinable()) {
    keeper_.join();
  }
  batch_replies_.reset();  // no late reply comes any more
  link_.reset();           // its end is reported to remaining members
}

Expected<void> NatsBroker::open(const BrokerOptions& options, const std::string& nkey) {
  options_ = options;
  identity_.nkey = nkey;
  identity_.inbox += options.inbox.empty() ? "" : "." + options.inbox;
  auto inbox = new_inbox();
  RAYLOC_TRY(inbox);
  batches_.set_inbox(*inbox);
  auto replies = listen(*inbox + "*", [this](natsMsg* message) { batches_.take(message); });
  RAYLOC_TRY(replies);
  batch_replies_ = *std::move(replies);
  if (Expected<void> first = connect(); !first && first.error().kind == ErrorKind::kConfiguration) {
    return first;
  }
  keeper_ = std::thread([this] { keep_linked(); });
  return {};
}

Link::Callbacks NatsBroker::callbacks() {
  Link::Callbacks callbacks;
  callbacks.connected = [this] { ++connections_; };
  callbacks.ended = [this] {
    const std::lock_guard lock(mutex_);
    is_link_due_ = true;
    changed_.notify_all();
  };
  callbacks.refused = [this](std::string words) { note_refusal(std::move(words)); };
  return callbacks;
}

Expected<void> NatsBroker::connect() {
  {
    const std::lock_guard lock(mutex_);
    is_link_due_ = false;  // a new one may end before it is stored here
  }
  auto made = Link::connect(options_, identity_, callbacks());
  std::shared_ptr<Link> before;  // ends when no mutex is held
  if (made) {
    const std::lock_guard listening(listening_);
    for (const std::shared_ptr<Slot>& slot : slots_) {
      (void)(*made)->listen(slot);  // it fails where the link has ended again
    }
    const std::lock_guard lock(mutex_);
    before = std::exchange(link_, *made);
    refusal_.clear();
    ++connections_;
    return {};
  }
  ++failed_tries_;
  note_refusal(made.error().message);
  const std::lock_guard lock(mutex_);
  is_link_due_ = true;
  return tl::make_unexpected(made.error());
}

// libnats reconnects by itself, as a rule: where it gives up, another link is made.
void NatsBroker::keep_linked() {
  std::chrono::milliseconds pause = kFirstPause;
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    changed_.wait(lock, [&] { return is_ending_ || is_link_due_; });
    if (changed_.wait_for(lock, pause, [&] { return is_ending_; })) {
      return;
    }
    lock.unlock();
    const bool is_linked = connect().has_value();
    lock.lock();
    pause = is_linked ? kFirstPause : std::min(2 * pause, kLongestPause);
  }
}

Expected<std::unique_ptr<Broker::Subscription>> NatsBroker::listen(const std::string& subject,
                                                                   Slot::Take take) {
  auto slot = std::make_shared<Slot>(subject, std::move(take));
  const std::lock_guard listening(listening_);
  std::shared_ptr<Link> link;
  {
    const std::lock_guard lock(mutex_);
    link = link_;
    if (is_link_due_) {
      link.reset();  // the next link subscribes
    }
  }
  if (link) {
    // Where it has just ended, the next link subscribes.
    if (const Expected<void> received = link->listen(slot); !received && link->is_connected()) {
      return tl::make_unexpected(received.error());
    }
  }
  slots_.push_back(slot);
  return std::make_unique<NatsSubscription>(*this, std::move(slot));
}

void NatsBroker::ignore(const std::shared_ptr<Slot>& slot) {
  {
    const std::lock_guard listening(listening_);
    slots_.remove(slot);
    std::shared_ptr<Link> link;
    {
      const std::lock_guard lock(mutex_);
      link = link_;
    }
    if (link) {
      link->ignore(slot);
    }
  }
  slot->close();
}

class NatsAckedPublisher final : public Broker::AckedPublisher {
 public:
  NatsAckedPublisher(const NatsBroker& broker,
                     std::string inbox,
                     std::unique_ptr<Broker::Subscription> acknowledgements)
      : broker_(broker), inbox_(std::move(inbox)), acknowledgements_(std::move(acknowledgements)) {}

  Expected<void> publish(const std::string& subject,
                         std::string_view data,
                         const std::string& id,
                         std::uint64_t token) override {
    const std::string reply = inbox_ + std::to_string(token);
    const auto link = broker_.linked();
    natsMsg* made = nullptr;
    natsStatus status =
        link
            ? natsMsg_Create(
                  &made, subject.c_str(), reply.c_str(), data.data(), static_cast<int>(data.size()))
            : NATS_CONNECTION_DISCONNECTED;
    const Message message(made);
    if (status == NATS_OK) {
      status = natsMsgHeader_Set(made, "Nats-Msg-Id", id.c_str());
    }
    if (status == NATS_OK) {
      status = natsConnection_PublishMsg(link->connection(), made);
    }
    return status == NATS_OK ? Expected<void>() : tl::make_unexpected(error_of(subject, status));
  }

 private:
  const NatsBroker& broker_;
  std::string inbox_;
  std::unique_ptr<Broker::Subscription> acknowledgements_;
};

// A new subject for replies to us, up to its last token.
Expected<std::string> NatsBroker::new_inbox() const {
  natsInbox* made = nullptr;
  if (const natsStatus status = natsInbox_Create(&made); status != NATS_OK) {
    return tl::make_unexpected(error_of("NATS", status));
  }
  // The library's own inbox begins with "_INBOX", whatever prefix its requests have.
  const std::string inbox =
      identity_.inbox + "." +
      std::string(std::string_view(made).substr(std::string_view(made).rfind('.') + 1)) + ".";
  natsInbox_Destroy(made);
  return inbox;
}

Expected<std::unique_ptr<Broker::AckedPublisher>> NatsBroker::acked_publisher(AckHandler handler) {
  const auto inbox = new_inbox();
  RAYLOC_TRY(inbox);
  auto acknowledgements =
      listen(*inbox + "*", [handler = std::move(handler), size = inbox->size()](natsMsg* message) {
        handler(number_of(std::string_view(natsMsg_GetSubject(message)).substr(size)),
                trouble_in(message));
      });
  RAYLOC_TRY(acknowledgements);
  return std::make_unique<NatsAckedPublisher>(*this, *inbox, *std::move(acknowledgements));
}

Expected<Published> NatsBroker::publish_behind(const std::string& subject,
                                               std::string_view data,
                                               std::uint64_t last) {
  const auto link = linked();
  if (!link) {
    return away(subject);
  }
  jsPubOptions options;
  jsPubOptions_Init(&options);
  options.MaxWait = kRequestMs;
  options.ExpectLastSubjectSeq = last;
  options.ExpectNoMessage = last == 0;
  jsPubAck* made = nullptr;
  jsErrCode code{};
  const natsStatus status = js_Publish(&made,
                                       link->jetstream(),
                                       subject.c_str(),
                                       data.data(),
                                       static_cast<int>(data.size()),
                                       &options,
                                       &code);
  const Ack acknowledgement(made);
  if (code == JSStreamWrongLastSequenceErr) {
    return Published{};
  }
  if (status != NATS_OK) {
    return tl::make_unexpected(error_of(subject, status));
  }
  return Published{true, acknowledgement->Sequence};
}

Expected<std::string> NatsBroker::ask(const std::string& subject, std::string_view data) {
  const auto link = linked();
  if (!link) {
    return away(subject);
  }
  natsMsg* made = nullptr;
  const natsStatus status = natsConnection_Request(&made,
                                                   link->connection(),
                                                   subject.c_str(),
                                                   data.data(),
                                                   static_cast<int>(data.size()),
                                                   kRequestMs);
  const Message answer(made);
  return status == NATS_OK ? Expected<std::string>(data_of(made))
                           : tl::make_unexpected(error_of(subject, status));
}

Expected<void> NatsBroker::ensure_stream(const StreamOptions& stream) {
  // Two machines that created one in the same instant made Debian's server unavailable
  // for a minute, as far as observed. An existing stream needs no request.
  if (stream_state(stream.name)) {
    return {};
  }
  const auto link = linked();
  if (!link) {
    return away("stream " + stream.name);
  }
  jsStreamConfig config;
  jsStreamConfig_Init(&config);
  config.Name = stream.name.c_str();
  const char* subjects = stream.subjects.c_str();
  config.Subjects = &subjects;
  config.SubjectsLen = 1;
  config.Storage = stream.in_memory ? js_MemoryStorage : js_FileStorage;
  config.Replicas = stream.replicas;
  config.MaxAge = stream.max_age.count() * kNanosecondsPerSecond;
  // A server refuses to remember ids for longer than the messages.
  config.Duplicates =
      stream.max_age.count() > 0 ? std::min(config.MaxAge, kRememberIds) : kRememberIds;
  config.AllowDirect = true;
  if (stream.max_bytes > 0) {
    config.MaxBytes = stream.max_bytes;
  }
  if (stream.max_messages_per_subject > 0) {
    config.MaxMsgsPerSubject = stream.max_messages_per_subject;
  }
  jsRePublish republish;
  jsRePublish_Init(&republish);
  if (!stream.republish_to.empty()) {
    republish.Source = subjects;
    republish.Destination = stream.republish_to.c_str();
    config.RePublish = &republish;
  }
  jsErrCode code{};
  const natsStatus status = js_AddStream(nullptr, link->jetstream(), &config, nullptr, &code);
  if (status == NATS_OK || code == JSStreamNameExistErr) {  // its creator's options take precedence
    return {};
  }
  return tl::make_unexpected(error_of("stream " + stream.name, status));
}

Expected<StreamState> NatsBroker::stream_state(const std::string& stream) {
  const auto link = linked();
  if (!link) {
    return away("stream " + stream);
  }
  jsStreamInfo* made = nullptr;
  const natsStatus status =
      js_GetStreamInfo(&made, link->jetstream(), stream.c_str(), nullptr, nullptr);
  const StreamInfo info(made);
  if (status != NATS_OK) {
    return tl::make_unexpected(error_of("stream " + stream, status));
  }
  return StreamState{Timestamp(Duration(info->Created)), info->State.FirstSeq, info->State.LastSeq};
}

Expected<std::optional<BrokerMessage>> NatsBroker::get(const std::string& stream,
                                                       std::uint64_t sequence) {
  const auto link = linked();
  if (!link) {
    return away("stream " + stream);
  }
  jsDirectGetMsgOptions which;
  jsDirectGetMsgOptions_Init(&which);
  which.Sequence = sequence;
  natsMsg* made = nullptr;
  const natsStatus status =
      js_DirectGetMsg(&made, link->jetstream(), stream.c_str(), nullptr, &which);
  return found(stream, status, Message(made));
}

Expected<std::vector<BrokerMessage>> NatsBroker::get_several(const std::string& stream,
                                                             const MessageRange& range) {
  const auto link = linked();
  if (!link) {
    return away("stream " + stream);
  }
  return batches_.get(*link, stream, range);
}

Expected<std::optional<BrokerMessage>> NatsBroker::get_of_leader(const std::string& stream,
                                                                 std::uint64_t sequence) {
  const auto link = linked();
  if (!link) {
    return away("stream " + stream);
  }
  natsMsg* made = nullptr;
  const natsStatus status =
      js_GetMsg(&made, link->jetstream(), stream.c_str(), sequence, nullptr, nullptr);
  return found(stream, status, Message(made));
}

Expected<std::optional<BrokerMessage>> NatsBroker::last_of(const std::string& stream,
                                                           const std::string& subject) {
  const auto link = linked();
  if (!link) {
    return away("stream " + stream);
  }
  natsMsg* made = nullptr;
  const natsStatus status =
      js_GetLastMsg(&made, link->jetstream(), stream.c_str(), subject.c_str(), nullptr, nullptr);
  return found(stream, status, Message(made));
}

}  // namespace

}  // namespace rayloc::nats

void rayloc_open_nats(const rayloc::BrokerOptions& options,
                      const std::string& nkey,
                      rayloc::Expected<std::shared_ptr<rayloc::Broker>>& opened) {
  auto broker = std::make_shared<rayloc::nats::NatsBroker>();
  if (const rayloc::Expected<void> begun = broker->open(options, nkey); !begun) {
    opened = tl::make_unexpected(begun.error());
    return;
  }
  opened = std::move(broker);
}
