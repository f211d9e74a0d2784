// FakeBroker: a Broker in memory, for tests of what a broker may do: be away, lose what it has
// acknowledged, forget its streams, answer late.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "daemon/live/cluster/broker.h"

namespace rayloc {

class FakeBroker final : public Broker {
 public:
  static constexpr std::uint64_t kAll = ~std::uint64_t{0};  // set_lagging()
  // The fate of the n-th message (from 0) that is to be stored.
  enum class Fate { kStored, kLost, kAcknowledgedAndLost, kAcknowledgementLost };
  std::function<Fate(std::uint64_t)> fate = [](std::uint64_t) { return Fate::kStored; };

  // Answers of the server about its streams; empty: it answers nothing. Set before the first use.
  std::function<std::string(const std::string& subject)> answer;

  std::size_t most = std::size_t{1} << 20U;  // bytes of a message; larger ones are refused

  void set_connected(bool connected) {
    const std::lock_guard lock(mutex_);
    connections_ += connected && !connected_ ? 1U : 0U;
    connected_ = connected;
  }
  // Acts as a restarted server with its streams in memory.
  // `later`: how much later the new streams seem to be created.
  void forget_streams(Duration later = Duration(0)) {
    const std::lock_guard lock(mutex_);
    streams_.clear();
    created_ += later.count();
  }
  // With false, requests to streams wait for their answers until it is true again.
  void set_answering(bool answering) {
    answering_ = answering;
    answering_.notify_all();
  }
  // The messages of all streams, in order.
  std::vector<BrokerMessage> stored() const {
    const std::lock_guard lock(mutex_);
    std::vector<BrokerMessage> all;
    for (const auto& [name, stream] : streams_) {
      for (const auto& [sequence, message] : stream.messages) {
        all.push_back(message);
      }
    }
    return all;
  }
  // Drops a message as retention does.
  void drop(const std::string& stream, std::uint64_t sequence) {
    const std::lock_guard lock(mutex_);
    streams_[stream].messages.erase(sequence);
  }
  // Acts as servers of which one was cut off: a queried replica lacks the messages after `replica`,
  // and the stream's leader those after `leader`.
  void set_lagging(std::uint64_t replica, std::uint64_t leader) {
    const std::lock_guard lock(mutex_);
    replica_has_ = replica;
    leader_has_ = leader;
  }
  // False: acts as a server before 2.11, which returns one message for each request.
  void set_giving_several(bool several) {
    const std::lock_guard lock(mutex_);
    gives_several_ = several;
  }
  // Number of requests to replicas.
  std::uint64_t gets() const {
    const std::lock_guard lock(mutex_);
    return gets_;
  }

  bool connected() const override {
    const std::lock_guard lock(mutex_);
    return connected_;
  }
  std::uint64_t connections() const override {
    const std::lock_guard lock(mutex_);
    return connections_;
  }

  std::size_t max_message() const override { return most; }

  Expected<std::unique_ptr<Subscription>> subscribe(const std::string& subject,
                                                    Handler handler) override;
  Expected<void> publish(const std::string& subject, std::string_view data) override {
    if (!connected()) {
      return away();
    }
    if (store(subject, data, "") == 0) {  // a stream delivers it itself
      deliver({subject, 0, std::string(data)}, subject);
    }
    return {};
  }
  Expected<std::unique_ptr<AckedPublisher>> acked_publisher(AckHandler handler) override {
    return std::make_unique<Acked>(*this, std::move(handler));
  }
  Expected<Published> publish_behind(const std::string& subject,
                                     std::string_view data,
                                     std::uint64_t last) override;
  Expected<std::string> ask(const std::string& subject, std::string_view /*data*/) override {
    if (!answer || !connected()) {
      return away();
    }
    return answer(subject);
  }
  Expected<void> ensure_stream(const StreamOptions& stream) override {
    const std::lock_guard lock(mutex_);
    if (!connected_) {
      return away();
    }
    if (streams_.find(stream.name) == streams_.end()) {
      streams_[stream.name] = {stream, ++created_, 0, {}, {}};
    }
    return {};
  }
  Expected<StreamState> stream_state(const std::string& name) override;
  Expected<std::optional<BrokerMessage>> get(const std::string& name,
                                             std::uint64_t sequence) override;
  Expected<std::vector<BrokerMessage>> get_several(const std::string& name,
                                                   const MessageRange& range) override;
  Expected<std::optional<BrokerMessage>> get_of_leader(const std::string& name,
                                                       std::uint64_t sequence) override;
  Expected<std::optional<BrokerMessage>> last_of(const std::string& name,
                                                 const std::string& subject) override;

 private:
  struct Stream {
    StreamOptions options;
    std::int64_t created = 0;
    std::uint64_t last = 0;
    std::map<std::uint64_t, BrokerMessage> messages;
    std::set<std::string> ids;
  };
  // Recursive, since a handler may publish to its own subject.
  struct Called {
    std::recursive_mutex mutex;
    Handler call;
  };
  class Fake final : public Subscription {
   public:
    Fake(FakeBroker& broker, std::uint64_t id, std::shared_ptr<Called> called)
        : broker_(broker), id_(id), called_(std::move(called)) {}
    ~Fake() override {
      {
        const std::lock_guard lock(broker_.mutex_);
        broker_.handlers_.erase(id_);
      }
      const std::lock_guard call(called_->mutex);  // waits for a call, as the connection does
      called_->call = nullptr;
    }

   private:
    FakeBroker& broker_;
    std::uint64_t id_;
    std::shared_ptr<Called> called_;
  };
  class Acked final : public AckedPublisher {
   public:
    Acked(FakeBroker& broker, AckHandler handler) : broker_(broker), handler_(std::move(handler)) {}
    Expected<void> publish(const std::string& subject,
                           std::string_view data,
                           const std::string& id,
                           std::uint64_t token) override {
      if (!broker_.connected()) {
        return away();
      }
      const Fate met = broker_.next_fate();
      if (met == Fate::kLost) {
        return {};
      }
      const bool stored = met == Fate::kAcknowledgedAndLost || broker_.store(subject, data, id) > 0;
      if (met != Fate::kAcknowledgementLost) {
        handler_(token, stored ? "" : "no stream takes it");
      }
      return {};
    }

   private:
    FakeBroker& broker_;
    AckHandler handler_;
  };

  // REQUIRES: the mutex is held. Answers as a server that has no message after `has`.
  Expected<std::optional<BrokerMessage>> found(const std::string& name,
                                               std::uint64_t sequence,
                                               std::uint64_t has);
  static tl::unexpected<Error> away() {
    return make_error(ErrorKind::kUnavailable, "the broker is away");
  }
  static std::string without_end(const std::string& wildcard) {
    return wildcard.substr(0, wildcard.find('>'));
  }
  static bool fits(const std::string& wildcard, const std::string& subject) {
    const std::string begin = without_end(wildcard);
    return begin.size() == wildcard.size() ? subject == begin : subject.rfind(begin, 0) == 0;
  }
  Stream* stream_of(const std::string& subject) {
    for (auto& [name, stream] : streams_) {
      if (fits(stream.options.subjects, subject)) {
        return &stream;
      }
    }
    return nullptr;
  }
  Fate next_fate() {
    const std::lock_guard lock(mutex_);
    return fate(published_++);
  }
  // Its sequence; 0 where no stream takes it.
  std::uint64_t store(const std::string& subject, std::string_view data, const std::string& id);
  void deliver(const BrokerMessage& message, const std::string& subject);

  void wait_to_answer() const { answering_.wait(false); }

  std::atomic<bool> answering_{true};
  mutable std::mutex mutex_;
  bool connected_ = true;
  std::uint64_t connections_ = 1;
  std::uint64_t subscriptions_ = 0;
  std::uint64_t published_ = 0;
  std::uint64_t replica_has_ = kAll;  // guarded by mutex_, as the next
  std::uint64_t leader_has_ = kAll;
  bool gives_several_ = true;
  std::uint64_t gets_ = 0;
  std::int64_t created_ = 0;
  std::map<std::string, Stream> streams_;
  std::map<std::uint64_t, std::pair<std::string, std::shared_ptr<Called>>> handlers_;
};

}  // namespace rayloc
