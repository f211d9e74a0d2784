// Conversion of messages of the library to BrokerMessage.
#pragma once

#include <nats/nats.h>

#include <charconv>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/nats/link.h"
#include "engine/base/expected.h"

namespace rayloc::nats {

template <typename T, void (*kDestroy)(T*)>
struct Destroy {
  void operator()(T* object) const { kDestroy(object); }
};
using Message = std::unique_ptr<natsMsg, Destroy<natsMsg, natsMsg_Destroy>>;

inline std::uint64_t number_of(std::string_view text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

// A message republished by a stream has its original subject and sequence in its headers.
inline BrokerMessage received(natsMsg* message) {
  BrokerMessage one;
  const char* subject = nullptr;
  const char* sequence = nullptr;
  if (natsMsgHeader_Get(message, "Nats-Subject", &subject) == NATS_OK &&
      natsMsgHeader_Get(message, "Nats-Sequence", &sequence) == NATS_OK) {
    one.sequence = number_of(sequence);
  } else {
    subject = natsMsg_GetSubject(message);
  }
  one.subject = subject;
  one.data = data_of(message);
  return one;
}

inline BrokerMessage stored(natsMsg* message) {
  return {natsMsg_GetSubject(message), natsMsg_GetSequence(message), data_of(message)};
}

// Returns nothing where the stream has no such message.
inline Expected<std::optional<BrokerMessage>> found(const std::string& stream,
                                                    natsStatus status,
                                                    const Message& message) {
  if (status == NATS_NOT_FOUND) {
    return std::nullopt;
  }
  if (status != NATS_OK) {
    return tl::make_unexpected(error_of("stream " + stream, status));
  }
  return stored(message.get());
}

}  // namespace rayloc::nats
