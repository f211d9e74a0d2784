// patient(): the deadlines of the tests, scaled to the machine.
#pragma once

#include <chrono>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RAYLOC_TEST_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define RAYLOC_TEST_SANITIZED 1
#endif
#endif

namespace rayloc::test {

// The factor of every deadline: $RAYLOC_PATIENCE, a number of at least 1 (1 if it is not set or
// not such a number), times 4 in a build with a sanitizer.
inline double patience_factor() noexcept {
  static const double kFactor = [] {
    const char* const stated = std::getenv("RAYLOC_PATIENCE");
    const double asked = stated == nullptr ? 1.0 : std::strtod(stated, nullptr);
#ifdef RAYLOC_TEST_SANITIZED
    constexpr double kBuild = 4.0;
#else
    constexpr double kBuild = 1.0;
#endif
    return kBuild * (asked >= 1.0 && asked <= 1000.0 ? asked : 1.0);
  }();
  return kFactor;
}

// The deadline of a wait that succeeds unless there is a fault. eventually(), Process::wait() and
// other test functions with a `patience` argument scale it themselves; patient() is for functions
// with a plain duration: a receive() of the product, a poll(). Durations that a test measures (a
// lease, a time-out of the product, a silence) are not scaled.
inline std::chrono::milliseconds patient(std::chrono::milliseconds patience) noexcept {
  return std::chrono::milliseconds(static_cast<std::chrono::milliseconds::rep>(
      static_cast<double>(patience.count()) * patience_factor()));
}

}  // namespace rayloc::test
