// ChildProcess: a program of ours that runs beside this one, for a person who uses a page.
//
// It inherits the environment, folder, limits and cgroup of this process, and
// nothing else: no descriptor, signal mask or group. If the memory of the cgroup
// is exhausted it is killed first. Its standard error goes to an unnamed file, so
// that it never waits for a reader. It has a lower priority than this process,
// and the kernel ends it when the thread that started it ends, for any reason.
//
// Thread safety: one thread at a time; the starting thread must outlive it.
#pragma once

#include <sys/types.h>

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

class ChildProcess {
 public:
  static Expected<std::unique_ptr<ChildProcess>> start(const std::filesystem::path& program,
                                                       const std::vector<std::string>& arguments);
  // Kills it if it has not ended.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // As reported by a shell (128 plus the ending signal); empty while it runs. Never waits.
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
