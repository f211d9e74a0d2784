// The JSON form of the public messages: protobuf's JSON mapping with the field names of the .proto
// files, and primitive fields printed even when they are zero. Times are RFC 3339 with 'Z', 64-bit
// numbers are strings, as in protobuf.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace google::protobuf {
class Message;
}  // namespace google::protobuf

namespace rayloc {

// One line, without its newline. An Error if JSON cannot represent it (a time beyond the year
// 9999), which occurs in foreign messages only.
Expected<std::string> to_json(const google::protobuf::Message& message);

// Replaces `message`. Field names as above or in lowerCamelCase; unknown fields are ignored, so
// that output of a later version can be read.
Expected<void> from_json(std::string_view json, google::protobuf::Message& message);

}  // namespace rayloc
