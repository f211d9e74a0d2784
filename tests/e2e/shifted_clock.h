// ShiftedClock: the machine's clock as a daemon with the shim of clock_shim.cpp sees it.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/test_paths.h"

namespace rayloc::e2e {

class ShiftedClock {
 public:
  explicit ShiftedClock(const std::filesystem::path& folder) : file_(folder / "clock") {
    const int fd = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    void* page = MAP_FAILED;
    if (fd >= 0 && ftruncate(fd, sizeof(std::int64_t)) == 0) {
      page = mmap(nullptr, sizeof(std::int64_t), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    }
    if (page == MAP_FAILED) {
      throw std::runtime_error("cannot share " + file_.string());
    }
    close(fd);
    shared_ = static_cast<std::atomic<std::int64_t>*>(page);
  }
  ~ShiftedClock() { munmap(shared_, sizeof(std::int64_t)); }
  ShiftedClock(const ShiftedClock&) = delete;
  ShiftedClock& operator=(const ShiftedClock&) = delete;

  std::vector<std::string> environment() const {
    return {"LD_PRELOAD=" + test::program_path("clock_shim.so"),
            "RAYLOC_CLOCK_SHIM=" + file_.string()};
  }
  void set(std::chrono::nanoseconds offset) { *shared_ = offset.count(); }

 private:
  std::filesystem::path file_;
  std::atomic<std::int64_t>* shared_;
};

}  // namespace rayloc::e2e
