#include "daemon/messages/json.h"

#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

namespace rayloc {

Expected<std::string> to_json(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = false;
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(message, &json, options);
  if (!status.ok()) {
    return bad_input(status.message().as_string());
  }
  return json;
}

Expected<void> from_json(std::string_view json, google::protobuf::Message& message) {
  google::protobuf::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  message.Clear();
  const auto status = google::protobuf::util::JsonStringToMessage(
      google::protobuf::StringPiece(json.data(), json.size()), &message, options);
  if (!status.ok()) {
    return bad_input(status.message().as_string());
  }
  return {};
}

}  // namespace rayloc
