// A publisher and a snapshot server behind one guard; a heartbeat is published every millisecond.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "daemon/live/publish/publisher.h"
#include "daemon/live/publish/snapshot_server.h"
#include "daemon/live/publish/socket/connection_guard.h"
#include "daemon/messages/last_messages.h"
#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc::test {

class GuardedDaemon {
 public:
  explicit GuardedDaemon(ConnectionGuard::Options access)
      : guard_(std::make_shared<ConnectionGuard>(std::move(access))) {
    const auto last = std::make_shared<LastMessages>(100);
    PublisherOptions publishing;
    publishing.endpoint = "tcp://127.0.0.1:*";
    publishing.site = "office";
    publishing.epoch = 5;
    publishing.last = last;
    publishing.guard = guard_;
    publisher_.emplace(std::move(*Publisher::bind(publishing)));
    endpoint_ = publisher_->endpoint();
    SnapshotServer::Options snapshots;
    snapshots.endpoint = "tcp://127.0.0.1:*";
    snapshots.epoch = 5;
    snapshots.last = last;
    snapshots.guard = guard_;
    snapshots_ = std::move(*SnapshotServer::open(snapshots));
    thread_ = std::thread([this] {
      while (!stopping_) {
        publisher_->publish(v1::Heartbeat(), Timestamp{std::chrono::seconds(1718000000)});
        subscriptions_ = publisher_->counters().subscriptions;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  }
  ~GuardedDaemon() {
    stopping_ = true;
    thread_.join();
  }
  GuardedDaemon(const GuardedDaemon&) = delete;
  GuardedDaemon& operator=(const GuardedDaemon&) = delete;

  const std::string& endpoint() const { return endpoint_; }
  const SnapshotServer& snapshots() const { return *snapshots_; }
  ConnectionGuard& guard() const { return *guard_; }
  std::uint64_t subscriptions() const { return subscriptions_; }

 private:
  std::shared_ptr<ConnectionGuard> guard_;
  std::optional<Publisher> publisher_;
  std::string endpoint_;
  std::unique_ptr<SnapshotServer> snapshots_;
  std::atomic<bool> stopping_ = false;
  std::atomic<std::uint64_t> subscriptions_ = 0;
  std::thread thread_;
};

}  // namespace rayloc::test
