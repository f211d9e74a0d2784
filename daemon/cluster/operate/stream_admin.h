// What a NATS server says of its streams, by the subjects on which JetStream answers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/cluster/broker.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// The subjects that the stream holds messages of.
Expected<std::vector<std::string>> subjects_of(Broker& broker, const std::string& stream);

// The messages of those subjects go.
Expected<void> forget_subjects(Broker& broker,
                               const std::string& stream,
                               const std::string& subjects);

// The stream goes, with all that it holds; one that is not there is gone.
Expected<void> forget_stream(Broker& broker, const std::string& stream);

// A stream as it is.
struct StreamReport {
  StreamOptions options;
  bool answers_directly = false;  // by any replica
  std::uint64_t bytes = 0;
  std::vector<std::string> troubles;  // of its replicas: "n2 is away", "n3 lacks 12 messages"
};
Expected<std::vector<StreamReport>> streams_of(Broker& broker);

// Of all streams together.
struct StoreReport {
  std::uint64_t memory = 0;  // bytes
  std::uint64_t files = 0;
  std::int64_t most_memory = -1;  // what the account may hold; -1: not limited
  std::int64_t most_files = -1;
};
Expected<StoreReport> store_of(Broker& broker);

// When the server stored the last message of that subject, by its clock; nothing: there is none.
Expected<std::optional<Timestamp>> last_stored(Broker& broker,
                                               const std::string& stream,
                                               const std::string& subject);

}  // namespace rayloc
