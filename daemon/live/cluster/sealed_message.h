// Seal around every message of a cluster (proto/rayloc/v1/cluster.proto): it
// marks the protocol and its version, and detects bytes that changed in transit.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace google::protobuf {
class MessageLite;
}  // namespace google::protobuf

namespace rayloc {

std::string seal(const google::protobuf::MessageLite& message);

// Parses it into `message`. An Error states the fault: no seal,
// another version, changed bytes, or bytes that are no such message.
Expected<void> unseal(std::string_view bytes, google::protobuf::MessageLite& message);

}  // namespace rayloc
