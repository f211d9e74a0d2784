#include "daemon/lab/recordings/time_text.h"

#include <array>
#include <chrono>
#include <cstdio>

namespace rayloc {

std::string time_text(Timestamp time) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const auto since_midnight = time - day;
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_midnight);
  const auto nanoseconds = (since_midnight - seconds).count();
  const auto of_day = seconds.count();
  const bool microseconds = nanoseconds % 1000 == 0;
  std::array<char, 64> text{};
  std::snprintf(text.data(),
                text.size(),
                "%04d-%02u-%02uT%02d:%02d:%02d.%0*dZ",
                static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()),
                static_cast<int>(of_day / 3600),
                static_cast<int>(of_day / 60 % 60),
                static_cast<int>(of_day % 60),
                microseconds ? 6 : 9,
                static_cast<int>(microseconds ? nanoseconds / 1000 : nanoseconds));
  return text.data();
}

}  // namespace rayloc
