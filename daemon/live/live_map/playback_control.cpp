#include "daemon/live/live_map/playback_control.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <string>

namespace rayloc {
namespace {

constexpr double kSlowest = 1e-3;
constexpr double kFastest = 1e6;

tl::unexpected<Error> wrong(const std::string& what) { return make_error(ErrorKind::kUsage, what); }

// Empty if the text is no number from `least` to `most`, or is NaN.
std::optional<double> number(const std::string& text, double least, double most) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  const bool good = read.ec == std::errc() && read.ptr == end && value >= least && value <= most;
  return good ? std::optional(value) : std::nullopt;
}

}  // namespace

Expected<Playback::Change> playback_change(const HttpParameters& parameters,
                                           const Playback::State& now) {
  Playback::Change change;
  const double length = to_seconds(now.end - now.begin);
  for (const auto& [key, value] : parameters) {
    if (parameters.count(key) > 1) {
      return wrong("'" + key + "' is there more than once");
    }
    if (key == "state") {
      if (value != "playing" && value != "paused") {
        return wrong("'state' is '" + value + "'; write playing or paused");
      }
      change.play = value == "playing";
    } else if (key == "speed") {
      const std::optional<double> speed = number(value, kSlowest, kFastest);
      if (!speed && value != "max") {
        return wrong("'speed' is '" + value + "'; write max, or a number from 0.001 to 1000000");
      }
      change.speed = speed;
    } else if (key == "position") {
      // A position counted in milliseconds may round to a value after the end.
      const std::optional<double> seconds = number(value, 0.0, std::numeric_limits<double>::max());
      if (!seconds) {
        return wrong("'position' is '" + value + "'; write seconds after the beginning, 0 or more");
      }
      change.position = now.begin + from_seconds(std::min(*seconds, length));
    } else {
      return wrong("'" + key + "' is not known; there are state, speed and position");
    }
  }
  if (parameters.empty()) {
    return wrong("nothing is asked for; write, for example, ?state=paused");
  }
  return change;
}

}  // namespace rayloc
