// Broker: the few operations of NATS JetStream that a cluster uses, so that
// all other code neither includes libnats nor needs a server in tests.
//
// It connects by itself, and reconnects for as long as it lives: a lost connection is a state and
// no Error. Nothing is buffered for an absent broker; a publisher keeps what is not acknowledged.
//
// Thread safety: any thread. Handlers are called by threads of the
// broker, serially for each subscription, and must not block them.
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
  std::string name;                  // of this machine, shown in the server's monitoring
  // Name within the subjects of replies to our requests, which come
  // to "_INBOX.INBOX.>"; other clients need no permission to
  // subscribe to these subjects. Empty: replies come to "_INBOX.>".
  std::string inbox = {};
  // TLS: the CA of the servers' certificates (empty: the CAs that this machine
  // trusts), and our own certificate with its key, where servers require one.
  // "tls://" in `servers`, or any of these: only TLS connections are made.
  std::string ca_file = {};
  std::string certificate_file = {};
  std::string key_file = {};
  std::string nkey_seed_file = {};  // our identity (operate/nkey.h); empty: anonymous
};

struct BrokerMessage {
  std::string subject;         // for a stored message: the subject of its publication
  std::uint64_t sequence = 0;  // in its stream; 0: not from a stream
  std::string data;
};

// Configuration of a stream to be created.
struct StreamOptions {
  std::string name;
  std::string subjects;      // with wildcards
  std::string republish_to;  // where stored messages are republished, "rayloc.v1.live.office.*"
  bool in_memory = true;
  int replicas = 1;
  std::chrono::seconds max_age{60};           // older messages are removed; zero: none
  std::int64_t max_bytes = 0;                 // the oldest messages beyond it are removed; 0: none
  std::int64_t max_messages_per_subject = 0;  // 0: any number
};

struct StreamState {
  Timestamp created;  // differs for another stream of that name
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

// Messages of a stream to be requested.
struct MessageRange {
  std::uint64_t first = 1;        // sequence
  std::size_t messages = 1;       // at most
  std::size_t bytes = 1U << 20U;  // it ends with the message that reaches so many
};

// Outcome of a publication with an expected last sequence.
struct Published {
  bool is_last = false;        // otherwise another client has published meanwhile
  std::uint64_t sequence = 0;  // of our message
};

class Broker {
 public:
  using Handler = std::function<void(BrokerMessage&&)>;
  // `token`: as passed. `trouble`: empty when the message is stored.
  using AckHandler = std::function<void(std::uint64_t token, const std::string& trouble)>;

  virtual ~Broker() = default;

  virtual bool connected() const = 0;
  // Number of connections so far: a change shows that the broker was away meanwhile.
  virtual std::uint64_t connections() const = 0;
  // Number of failed connection attempts since it was opened.
  virtual std::uint64_t failed_tries() const { return 0; }
  // Size of the largest message that it accepts [bytes].
  virtual std::size_t max_message() const = 0;
  // Last refusal by the server, in its words: of our login or of a request; empty: none.
  virtual std::string refusal() const { return ""; }

  // Lasts until the Subscription is destroyed; continues by itself
  // after a lost connection. `subject` may contain wildcards.
  class Subscription {
   public:
    virtual ~Subscription() = default;
  };
  virtual Expected<std::unique_ptr<Subscription>> subscribe(const std::string& subject,
                                                            Handler handler) = 0;

  // Publishes to the present subscribers.
  virtual Expected<void> publish(const std::string& subject, std::string_view data) = 0;

  // Publishes to a stream, without waiting. `id`: a second message of that id within the stream's
  // deduplication window is acknowledged and not stored. The acknowledgement may never arrive.
  class AckedPublisher {
   public:
    virtual ~AckedPublisher() = default;
    virtual Expected<void> publish(const std::string& subject,
                                   std::string_view data,
                                   const std::string& id,
                                   std::uint64_t token) = 0;
  };
  virtual Expected<std::unique_ptr<AckedPublisher>> acked_publisher(AckHandler handler) = 0;

  // Stores in a stream if `last` is the sequence of the last message of that subject; 0: none.
  virtual Expected<Published> publish_behind(const std::string& subject,
                                             std::string_view data,
                                             std::uint64_t last) = 0;

  // Reply of the responder on this subject. For the server's own subjects (stream_admin.h).
  virtual Expected<std::string> ask(const std::string& subject, std::string_view data) = 0;

  // Creates the stream, or finds that it exists.
  virtual Expected<void> ensure_stream(const StreamOptions& stream) = 0;
  virtual Expected<StreamState> stream_state(const std::string& stream) = 0;
  // Returns one message of a stream, from any replica; nothing
  // where no message of that sequence exists (any more).
  virtual Expected<std::optional<BrokerMessage>> get(const std::string& stream,
                                                     std::uint64_t sequence) = 0;
  // Returns the message of sequence `first` and those that follow it, ascending, by one request to
  // any replica; from a server before 2.11 that message alone. Fewer where replies are missing.
  // None where no message of that sequence exists (any more).
  virtual Expected<std::vector<BrokerMessage>> get_several(const std::string& stream,
                                                           const MessageRange& range) = 0;
  // As get(), from the stream's leader, which has all stored messages while its peers reach it.
  virtual Expected<std::optional<BrokerMessage>> get_of_leader(const std::string& stream,
                                                               std::uint64_t sequence) = 0;
  // Returns the last message of that subject, from the stream's leader.
  virtual Expected<std::optional<BrokerMessage>> last_of(const std::string& stream,
                                                         const std::string& subject) = 0;
};

// Begins to connect and returns at once. An Error where the NATS module is not installed
// (nats/module.h), or where a server's address, a certificate or a seed cannot be parsed.
Expected<std::shared_ptr<Broker>> open_broker(const BrokerOptions& options);

}  // namespace rayloc
