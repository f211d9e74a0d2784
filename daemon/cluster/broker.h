// Broker: the few things that a cluster asks of NATS JetStream, so that everything else neither
// includes libnats nor needs a server to be tested.
//
// It connects by itself, and again for as long as it lives: being away is a state and no Error.
// Nothing is kept for a broker that is away; who publishes keeps what is not acknowledged.
//
// Thread safety: any thread. Handlers are called by threads of the broker, one after the other for
// each subscription, and must not block them.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

struct BrokerOptions {
  std::vector<std::string> servers;  // "nats://127.0.0.1:4222"
  std::string name;                  // of this machine, for who looks at the server
  // What is asked for comes to "_INBOX.INBOX.>", which others need not be allowed to hear; empty:
  // to
  // "_INBOX.>".
  std::string inbox = {};
  // TLS: who signed the servers' certificates (empty: whom this machine trusts), and our own with
  // its key, where servers ask for one. "tls://" in `servers`, or any of these: no other
  // connection.
  std::string ca_file = {};
  std::string certificate_file = {};
  std::string key_file = {};
  std::string nkey_seed_file = {};  // who we are (operate/nkey.h); empty: anybody
};

struct BrokerMessage {
  std::string subject;         // of a message of a stream: the one that it was published to
  std::uint64_t sequence = 0;  // in its stream; 0: of none
  std::string data;
};

// A stream as it is to be made.
struct StreamOptions {
  std::string name;
  std::string subjects;      // with wildcards
  std::string republish_to;  // where what is stored is told at once, "rayloc.v1.live.office.*"
  bool in_memory = true;
  int replicas = 1;
  std::chrono::seconds max_age{60};           // what is older goes; zero: nothing
  std::int64_t max_bytes = 0;                 // what is more goes, the oldest first; 0: nothing
  std::int64_t max_messages_per_subject = 0;  // 0: any number
};

struct StreamState {
  Timestamp created;  // another stream of that name has another
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

// What became of a message that was published behind another.
struct Published {
  bool is_last = false;        // else somebody else has published behind that one
  std::uint64_t sequence = 0;  // of ours
};

class Broker {
 public:
  using Handler = std::function<void(BrokerMessage&&)>;
  // `token`: as passed. `trouble`: empty when the message is stored.
  using AckHandler = std::function<void(std::uint64_t token, const std::string& trouble)>;

  virtual ~Broker() = default;

  virtual bool connected() const = 0;
  // How often it has connected: who asks can tell that it was away meanwhile.
  virtual std::uint64_t connections() const = 0;
  // How often it has tried to in vain, since it was opened.
  virtual std::uint64_t failed_tries() const { return 0; }
  // Bytes of the largest message that it takes.
  virtual std::size_t max_message() const = 0;
  // What the server refused last, in its words: us, or what we asked for; empty: nothing.
  virtual std::string refusal() const { return ""; }

  // Until the Subscription is destroyed; goes on by itself after the broker was away. `subject`
  // with wildcards.
  class Subscription {
   public:
    virtual ~Subscription() = default;
  };
  virtual Expected<std::unique_ptr<Subscription>> subscribe(const std::string& subject,
                                                            Handler handler) = 0;

  // To whoever listens now.
  virtual Expected<void> publish(const std::string& subject, std::string_view data) = 0;

  // To a stream, without waiting. `id`: a second message of that id within the stream's memory is
  // acknowledged and not stored. The acknowledgement may stay away for good.
  class AckedPublisher {
   public:
    virtual ~AckedPublisher() = default;
    virtual Expected<void> publish(const std::string& subject,
                                   std::string_view data,
                                   const std::string& id,
                                   std::uint64_t token) = 0;
  };
  virtual Expected<std::unique_ptr<AckedPublisher>> acked_publisher(AckHandler handler) = 0;

  // To a stream, if `last` is the sequence of the last message of that subject; 0: there is none.
  virtual Expected<Published> publish_behind(const std::string& subject,
                                             std::string_view data,
                                             std::uint64_t last) = 0;

  // What the one that answers on this subject says. For the server's own subjects (stream_admin.h).
  virtual Expected<std::string> ask(const std::string& subject, std::string_view data) = 0;

  // Makes the stream, or sees that there is one.
  virtual Expected<void> ensure_stream(const StreamOptions& stream) = 0;
  virtual Expected<StreamState> stream_state(const std::string& stream) = 0;
  // One message of a stream that any replica may answer; nothing where there is none of that
  // sequence (any more).
  virtual Expected<std::optional<BrokerMessage>> get(const std::string& stream,
                                                     std::uint64_t sequence) = 0;
  // The same, by the stream's leader, who has all that was stored as long as the others hear it.
  virtual Expected<std::optional<BrokerMessage>> get_of_leader(const std::string& stream,
                                                               std::uint64_t sequence) = 0;
  // The last one of that subject, by the stream's leader.
  virtual Expected<std::optional<BrokerMessage>> last_of(const std::string& stream,
                                                         const std::string& subject) = 0;
};

// Begins to connect and returns at once. An Error where the module that does is not installed
// (nats/nats_module.h), or where a server's address, a certificate or a seed cannot be understood.
Expected<std::shared_ptr<Broker>> open_broker(const BrokerOptions& options);

}  // namespace rayloc
