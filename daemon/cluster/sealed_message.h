// The seal around every message of a cluster (proto/rayloc/v1/cluster.proto): whose it is, in which
// version, and that no byte of it has changed on its way.
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

// Reads it into `message`. An Error says what is wrong: no seal, another version, bytes that have
// changed, or bytes that are no such message.
Expected<void> unseal(std::string_view bytes, google::protobuf::MessageLite& message);

}  // namespace rayloc
