// Link: one connection of libnats, until it ends permanently. Two rules for libnats
// 3.4.1: a subscription is never destroyed while its connection is open (messages that arrive
// then cause a use after free, fixed in 3.6.1), and natsSubscription_Fetch() is not used (its
// time-out is wrong until then). One limit: a server that becomes silent between its greeting
// and its first answer blocks natsConnection_Connect() for as long as it is silent.
//
// Thread safety: any thread.
#pragma once

#include <nats/nats.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "daemon/live/cluster/nats/options.h"
#include "engine/base/expected.h"

namespace rayloc::nats {

inline constexpr int kRequestMs = 2000;  // for a reply

// State of a subscription: it outlives its connections; its handler does not.
class Slot {
 public:
  using Take = std::function<void(natsMsg*)>;
  Slot(std::string subject, Take take) : subject_(std::move(subject)), take_(std::move(take)) {}
  const std::string& subject() const { return subject_; }
  // After this has returned, no handler runs any more.
  void close() {
    const std::lock_guard lock(mutex_);
    take_ = nullptr;
  }
  void take(natsMsg* message) {
    const std::lock_guard lock(mutex_);
    if (take_) {
      take_(message);
    }
  }

 private:
  const std::string subject_;
  std::mutex mutex_;
  Take take_;  // guarded by mutex_
};

class Link {
 public:
  // Called by threads of libnats.
  struct Callbacks {
    std::function<void()> connected;  // reconnected by itself
    std::function<void()> ended;      // permanently; once
    std::function<void(std::string words)> refused;
  };

  // Tries each server once. libnats reconnects by itself, but not
  // where a server was silent or refused us at the first try.
  // An Error of kind kConfiguration: another try would fail too.
  static Expected<std::shared_ptr<Link>> connect(const BrokerOptions& options,
                                                 const Identity& identity,
                                                 Callbacks callbacks);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  // Does not call libnats, which answers such calls after pending writes.
  bool is_connected() const { return connected_; }
  natsConnection* connection() const { return connection_; }
  jsCtx* jetstream() const { return jetstream_; }

  Expected<void> listen(std::shared_ptr<Slot> slot);
  void ignore(const std::shared_ptr<Slot>& slot);

 private:
  explicit Link(Callbacks callbacks) : callbacks_(std::move(callbacks)) {}
  Expected<void> open(const BrokerOptions& options, const Identity& identity);
  Expected<void> prepare(natsOptions* made, const BrokerOptions& options, const Identity& identity);
  static void note_connected(natsConnection*, void* self);
  static void note_disconnected(natsConnection*, void* self);
  static void note_closed(natsConnection*, void* self);
  static void note_error(natsConnection*, natsSubscription*, natsStatus, void* self);

  const Callbacks callbacks_;
  natsConnection* connection_ = nullptr;
  jsCtx* jetstream_ = nullptr;
  std::atomic<bool> connected_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;  // guarded by mutex_
  // Guarded by mutex_; until the connection ends.
  std::vector<std::pair<std::shared_ptr<Slot>, natsSubscription*>> subscriptions_;
};

}  // namespace rayloc::nats
