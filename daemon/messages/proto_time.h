// Converts times of messages from and to our own.
#pragma once

#include <google/protobuf/duration.pb.h>
#include <google/protobuf/timestamp.pb.h>

#include "engine/base/timestamp.h"

namespace rayloc {

google::protobuf::Timestamp to_proto(Timestamp time);
google::protobuf::Duration to_proto(Duration duration);
// A time beyond the range of Timestamp (the year 2262) becomes its first or last day.
Timestamp from_proto(const google::protobuf::Timestamp& time);
// A duration beyond the range of Duration (292 years) becomes its first or last day.
Duration from_proto(const google::protobuf::Duration& duration);

}  // namespace rayloc
