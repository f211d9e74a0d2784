#include "daemon/cli/arguments/time_arguments.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <system_error>

namespace rayloc::cli {
namespace {

struct Quantity {
  double value = 0.0;
  std::string unit;
};

// Returns empty if `text` does not begin with a number.
std::optional<Quantity> parse_quantity(const std::string& text) {
  Quantity quantity;
  const auto [end, status] =
      std::from_chars(text.data(), text.data() + text.size(), quantity.value);
  if (status != std::errc()) {
    return std::nullopt;
  }
  quantity.unit.assign(end, text.data() + text.size());
  return quantity;
}

}  // namespace

Expected<Duration> parse_burst_argument(const std::string& text) {
  const std::optional<Quantity> burst = parse_quantity(text);
  if (burst && (burst->unit.empty() || burst->unit == "s" || burst->unit == "ms")) {
    const double seconds = burst->value * (burst->unit == "ms" ? 1e-3 : 1.0);
    if (seconds >= 1e-3 && seconds <= 60.0) {
      return from_seconds(seconds);
    }
  }
  return make_error(
      ErrorKind::kUsage,
      "--burst " + text + ": write a duration from 1ms to 60s, for example 0.2s or 500ms");
}

Expected<std::optional<double>> parse_speed_argument(const std::string& text) {
  if (text == "max") {
    return std::optional<double>();
  }
  const std::optional<Quantity> speed = parse_quantity(text);
  if (!speed || !speed->unit.empty() || !(speed->value > 0.0) || speed->value > 1e6) {
    return make_error(ErrorKind::kUsage,
                      "--speed " + text + ": write max, or how many times faster than recorded: 1");
  }
  return std::optional<double>(speed->value);
}

Expected<double> parse_pace_argument(const std::string& text) {
  if (text == "max") {
    return std::numeric_limits<double>::infinity();
  }
  char* end = nullptr;
  const double speed = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(speed) || speed <= 0) {
    return make_error(ErrorKind::kUsage, "--speed " + text + ": write a number above 0, or max");
  }
  return speed;
}

}  // namespace rayloc::cli
