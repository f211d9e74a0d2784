// The JSON form of the public messages: protobuf's JSON mapping with the field names of the .proto
// files, and primitive fields printed even when they are zero. Times are RFC 3339 with 'Z', 64-bit
// numbers are strings, as protobuf has it.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace google::protobuf {
class Message;
}  // namespace google::protobuf

namespace rayloc {

// One line, without its newline. An Error for what JSON has no form for (a time beyond the year
// 9999), which only messages of others can hold.
Expected<std::string> to_json(const google::protobuf::Message& message);

// Replaces `message`. Field names as above or in lowerCamelCase; unknown fields are ignored, so
// that what a later version writes can be read.
Expected<void> from_json(std::string_view json, google::protobuf::Message& message);

}  // namespace rayloc
