#include "daemon/publish/proto_time.h"

namespace rayloc {

google::protobuf::Timestamp to_proto(Timestamp time) {
  // Rounded down: protobuf's nanos of a time before 1970 are positive too.
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  google::protobuf::Timestamp proto;
  proto.set_seconds(seconds.time_since_epoch().count());
  proto.set_nanos(static_cast<std::int32_t>((time - seconds).count()));
  return proto;
}

google::protobuf::Duration to_proto(Duration duration) {
  // Rounded towards zero: protobuf's nanos of a negative duration are negative.
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  google::protobuf::Duration proto;
  proto.set_seconds(seconds.count());
  proto.set_nanos(static_cast<std::int32_t>((duration - seconds).count()));
  return proto;
}

Timestamp from_proto(const google::protobuf::Timestamp& time) {
  constexpr auto kMost = std::chrono::floor<std::chrono::seconds>(Timestamp::max()) -
                         std::chrono::seconds(4);  // nanos of either sign fit in an int32: 2.1 s
  const std::int64_t limit = kMost.time_since_epoch().count();
  if (time.seconds() > limit) {
    return Timestamp::max();
  }
  if (time.seconds() < -limit) {
    return Timestamp::min();
  }
  return Timestamp(std::chrono::seconds(time.seconds()) + std::chrono::nanoseconds(time.nanos()));
}

}  // namespace rayloc
