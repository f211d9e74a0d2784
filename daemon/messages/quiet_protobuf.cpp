#include "daemon/messages/quiet_protobuf.h"

#include <google/protobuf/stubs/logging.h>

namespace rayloc {

void quiet_protobuf() { google::protobuf::SetLogHandler(nullptr); }

}  // namespace rayloc
