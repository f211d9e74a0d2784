#include "daemon/live/machine/process_load.h"

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <thread>

namespace rayloc {
namespace {

std::chrono::microseconds used_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::chrono::seconds(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         std::chrono::microseconds(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

double processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0 && CPU_COUNT(&allowed) > 0) {
    return CPU_COUNT(&allowed);
  }
  return std::max(1U, std::thread::hardware_concurrency());
}

}  // namespace

ProcessLoad::ProcessLoad() : measured_(std::chrono::steady_clock::now()), used_(used_time()) {}

double ProcessLoad::measure() {
  const Time now = std::chrono::steady_clock::now();
  if (now - measured_ < kEvery) {
    return load_;
  }
  const std::chrono::microseconds used = used_time();
  const std::chrono::duration<double> busy = used - used_;
  const std::chrono::duration<double> passed = now - measured_;
  load_ = std::clamp(busy / passed / processors(), 0.0, 1.0);
  measured_ = now;
  used_ = used;
  return load_;
}

}  // namespace rayloc
