#include "daemon/live/cluster/nats/link.h"

#include <algorithm>

namespace rayloc::nats {
namespace {

constexpr int kPingMs = 1000;  // a server that misses two replies is away
constexpr int kReconnectMs = 250;
constexpr int kConnectMs = 1000;
// A server that accepts no data for so long is away: writes do not wait longer.
constexpr int kWriteMs = 1000;
constexpr int kDeliveryThreads = 2;  // of this process, for all subscriptions

struct DestroyOptions {
  void operator()(natsOptions* options) const { natsOptions_Destroy(options); }
};

void deliver(natsConnection*, natsSubscription*, natsMsg* message, void* slot) {
  (*static_cast<std::shared_ptr<Slot>*>(slot))->take(message);
  natsMsg_Destroy(message);
}

// Called by libnats after the last delivery to it.
void forget(void* slot) { delete static_cast<std::shared_ptr<Slot>*>(slot); }

bool is_configuration(natsStatus status) {
  return status == NATS_INVALID_ARG || status == NATS_ADDRESS_MISSING;
}

}  // namespace

Expected<std::shared_ptr<Link>> Link::connect(const BrokerOptions& options,
                                              const Identity& identity,
                                              Callbacks callbacks) {
  std::shared_ptr<Link> link(new Link(std::move(callbacks)));
  RAYLOC_TRY(link->open(options, identity));
  return link;
}

// libnats reports the end from another thread, and does not use this object after that.
Link::~Link() {
  if (connection_ != nullptr) {
    natsConnection_Close(connection_);
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_; });
    for (const auto& [slot, subscription] : subscriptions_) {
      natsSubscription_Destroy(subscription);
    }
  }
  jsCtx_Destroy(jetstream_);
  natsConnection_Destroy(connection_);
}

Expected<void> Link::prepare(natsOptions* made,
                             const BrokerOptions& options,
                             const Identity& identity) {
  std::vector<const char*> servers;
  servers.reserve(options.servers.size());
  for (const std::string& server : options.servers) {
    servers.push_back(server.c_str());
  }
  constexpr int kForEver = -1;
  constexpr int kNothing = 1;  // byte; 0 is the default of 8 MiB, and -1 is refused
  for (const natsStatus status :
       {natsOptions_SetServers(made, servers.data(), static_cast<int>(servers.size())),
        natsOptions_SetName(made, options.name.c_str()),
        natsOptions_SetTimeout(made, kConnectMs),
        natsOptions_SetMaxReconnect(made, kForEver),
        natsOptions_SetReconnectWait(made, kReconnectMs),
        natsOptions_SetReconnectBufSize(made, kNothing),
        natsOptions_SetFailRequestsOnDisconnect(made, true),
        natsOptions_SetPingInterval(made, kPingMs),
        natsOptions_SetMaxPingsOut(made, 2),
        natsOptions_SetSendAsap(made, true),
        natsOptions_SetWriteDeadline(made, kWriteMs),
        natsOptions_UseGlobalMessageDelivery(made, true),
        natsOptions_SetErrorHandler(made, note_error, this),
        natsOptions_SetCustomInboxPrefix(made, identity.inbox.c_str()),
        natsOptions_SetReconnectedCB(made, note_connected, this),
        natsOptions_SetDisconnectedCB(made, note_disconnected, this),
        natsOptions_SetClosedCB(made, note_closed, this)}) {
    if (status != NATS_OK) {
      Error error = error_of("[cluster] servers", status);
      error.kind = ErrorKind::kConfiguration;
      return tl::make_unexpected(std::move(error));
    }
  }
  return secure(made, options, identity.nkey);
}

Expected<void> Link::open(const BrokerOptions& options, const Identity& identity) {
  nats_SetMessageDeliveryPoolSize(kDeliveryThreads);
  natsOptions* made = nullptr;
  if (const natsStatus status = natsOptions_Create(&made); status != NATS_OK) {
    return tl::make_unexpected(error_of("NATS", status));
  }
  const std::unique_ptr<natsOptions, DestroyOptions> all(made);
  RAYLOC_TRY(prepare(made, options, identity));
  const natsStatus status = natsConnection_Connect(&connection_, made);
  if (status != NATS_OK) {
    connection_ = nullptr;
    Error error = error_of("[cluster] servers", status);
    error.kind = is_configuration(status) ? ErrorKind::kConfiguration : error.kind;
    return tl::make_unexpected(std::move(error));
  }
  connected_ = true;
  jsOptions jetstream;
  jsOptions_Init(&jetstream);
  jetstream.Wait = kRequestMs;
  const natsStatus context = natsConnection_JetStream(&jetstream_, connection_, &jetstream);
  return context == NATS_OK ? Expected<void>() : tl::make_unexpected(error_of("NATS", context));
}

Expected<void> Link::listen(std::shared_ptr<Slot> slot) {
  auto* const held = new std::shared_ptr<Slot>(slot);  // forget() deletes it
  natsSubscription* made = nullptr;
  const natsStatus status =
      natsConnection_Subscribe(&made, connection_, slot->subject().c_str(), deliver, held);
  if (status != NATS_OK) {
    forget(held);
    return tl::make_unexpected(error_of(slot->subject(), status));
  }
  natsSubscription_SetOnCompleteCB(made, forget, held);
  constexpr int kAnyNumber = -1;
  constexpr int kMaxBytes = 64 << 20;  // waiting for us, per subscription
  natsSubscription_SetPendingLimits(made, kAnyNumber, kMaxBytes);
  const std::lock_guard lock(mutex_);
  subscriptions_.emplace_back(std::move(slot), made);
  return {};
}

void Link::ignore(const std::shared_ptr<Slot>& slot) {
  natsSubscription* subscription = nullptr;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(subscriptions_.begin(),
                                    subscriptions_.end(),
                                    [&](const auto& one) { return one.first == slot; });
    subscription = found != subscriptions_.end() ? found->second : nullptr;
  }
  if (subscription != nullptr) {
    natsSubscription_Unsubscribe(subscription);  // the end of the connection destroys it
  }
}

void Link::note_connected(natsConnection*, void* self) {
  auto& link = *static_cast<Link*>(self);
  link.callbacks_
      .connected();  // first: a caller that observes the connection must see the new count
  link.connected_ = true;
}

void Link::note_disconnected(natsConnection*, void* self) {
  static_cast<Link*>(self)->connected_ = false;
}

void Link::note_closed(natsConnection*, void* self) {
  auto& link = *static_cast<Link*>(self);
  link.connected_ = false;
  link.callbacks_.ended();
  const std::lock_guard lock(link.mutex_);
  link.ended_ = true;
  link.changed_.notify_all();
}

// Messages lost by a subscription with a slow reader are read from the stream (StreamReader).
void Link::note_error(natsConnection* connection,
                      natsSubscription*,
                      natsStatus status,
                      void* self) {
  if (status == NATS_SLOW_CONSUMER) {
    return;
  }
  const char* words = nullptr;
  natsConnection_GetLastError(connection, &words);
  static_cast<Link*>(self)->callbacks_.refused(
      words != nullptr && *words != '\0' ? words : natsStatus_GetText(status));
}

}  // namespace rayloc::nats
