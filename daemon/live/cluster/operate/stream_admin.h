// Information of a NATS server about its streams, over the subjects on which JetStream answers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/live/cluster/broker.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Returns the subjects of the stored messages of the stream.
Expected<std::vector<std::string>> subjects_of(Broker& broker, const std::string& stream);

// Deletes the messages of those subjects.
Expected<void> forget_subjects(Broker& broker,
                               const std::string& stream,
                               const std::string& subjects);

// Deletes the stream, with all its messages; a missing one is no Error.
Expected<void> forget_stream(Broker& broker, const std::string& stream);

// State of a stream.
struct StreamReport {
  StreamOptions options;
  bool answers_directly = false;  // by any replica
  std::uint64_t bytes = 0;
  // Faults of its replicas: "n2 is offline", "n3 is behind by 12 messages".
  std::vector<std::string> troubles;
};
Expected<std::vector<StreamReport>> streams_of(Broker& broker);

// Storage of all streams together.
struct StoreReport {
  std::uint64_t memory = 0;  // bytes
  std::uint64_t files = 0;
  std::int64_t most_memory = -1;  // limit of the account; -1: unlimited
  std::int64_t most_files = -1;
};
Expected<StoreReport> store_of(Broker& broker);

// Time when the server stored the last message of that subject, by its clock; nothing: none.
Expected<std::optional<Timestamp>> last_stored(Broker& broker,
                                               const std::string& stream,
                                               const std::string& subject);

}  // namespace rayloc
