#include "daemon/messages/proto_time.h"

namespace rayloc {
namespace {

Duration within_range(std::int64_t seconds, std::int32_t nanos) {
  // A day before the end, so that rounding to a day does not overflow.
  constexpr auto kLast =
      std::chrono::floor<std::chrono::days>(Duration::max()) - std::chrono::days(1);
  constexpr std::int64_t kLimit = std::chrono::seconds(kLast).count();
  if (seconds > kLimit || seconds < -kLimit) {
    return std::chrono::seconds(seconds > 0 ? kLimit : -kLimit);
  }
  return std::chrono::seconds(seconds) + std::chrono::nanoseconds(nanos);
}

}  // namespace

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
  return Timestamp(within_range(time.seconds(), time.nanos()));
}

Duration from_proto(const google::protobuf::Duration& duration) {
  return within_range(duration.seconds(), duration.nanos());
}

}  // namespace rayloc
