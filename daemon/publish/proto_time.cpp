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
  // A day short of the end, so that nobody who rounds to a day overflows.
  constexpr auto kLast =
      std::chrono::floor<std::chrono::days>(Timestamp::max()) - std::chrono::days(1);
  constexpr std::int64_t kLimit = std::chrono::seconds(kLast.time_since_epoch()).count();
  if (time.seconds() > kLimit) {
    return Timestamp(std::chrono::seconds(kLimit));
  }
  if (time.seconds() < -kLimit) {
    return Timestamp(std::chrono::seconds(-kLimit));
  }
  return Timestamp(std::chrono::seconds(time.seconds()) + std::chrono::nanoseconds(time.nanos()));
}

}  // namespace rayloc
