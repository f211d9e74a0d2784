// ChildProcess: a program that runs beside this one, for a person who uses a page.
//
// It inherits the environment, folder, limits and cgroup of this process, and
// nothing else: no descriptor (except those of ChildSettings), signal mask or group. If the memory
// of the cgroup is exhausted it is killed first. Its standard error goes to an unnamed file, so
// that it never waits for a reader. It has a lower priority than this process,
// and the kernel ends it when the thread that started it ends, for any reason.
//
// Thread safety: one thread at a time; the starting thread must outlive it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

// The program `rayloc` of this installation: beside this one, or in bin beside its folder.
Expected<std::filesystem::path> rayloc_program();

// Standard descriptors and limits of a process. Copies of the descriptors are made when it starts,
// and the offset of a file is shared with it.
struct ChildSettings {
  int input = -1;   // -1: /dev/null
  int output = -1;  // same
  // Limits that the kernel enforces (setrlimit(2)), if they are lower than those of this process;
  // 0: those of this process. With any of them it writes no core file.
  std::uint64_t memory_bytes = 0;       // address space
  std::uint64_t processor_seconds = 0;  // above it SIGXCPU ends it
  std::uint64_t file_bytes = 0;         // of each file that it writes; above it SIGXFSZ ends it
};

class ChildProcess {
 public:
  // Status as in a shell: the program cannot be started; this plus the signal that ended it.
  static constexpr int kCannotStart = 127;
  static constexpr int kBySignal = 128;

  static Expected<std::unique_ptr<ChildProcess>> start(const std::filesystem::path& program,
                                                       const std::vector<std::string>& arguments,
                                                       const ChildSettings& settings = {});
  // Kills it if it has not ended.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // kBySignal plus the ending signal, or the exit status; empty while it runs. Never waits.
  std::optional<int> status();
  // Asks it to end (SIGTERM); the second call kills it (SIGKILL).
  void stop();
  bool was_stopped() const { return stopped_; }
  // The last part of its standard error.
  std::string errors() const;

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  ChildProcess(pid_t process, File errors) : process_(process), errors_(std::move(errors)) {}

  pid_t process_;
  File errors_;
  std::optional<int> status_;
  bool stopped_ = false;
};

}  // namespace rayloc
