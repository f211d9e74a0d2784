// ChildProcess: a program of ours that works beside this one, for a person who looks at a page.
//
// It has the environment, folder, limits and cgroup of this process, and nothing else: no
// descriptor, no signal mask, no group. Where the memory of the cgroup ends it goes first. What
// it says on standard error goes to a file without a name, so that it never waits for somebody who
// reads. It yields the processor to this process, and the kernel ends it when the thread that
// started it is gone, however it went.
//
// Thread safety: one thread at a time; the one that starts it lives as long as it.
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

// The program `rayloc` that came with this one: beside it, or in bin beside its folder.
Expected<std::filesystem::path> rayloc_program();

class ChildProcess {
 public:
  static Expected<std::unique_ptr<ChildProcess>> start(const std::filesystem::path& program,
                                                       const std::vector<std::string>& arguments);
  // Kills it where it has not ended.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // As a shell tells it (128 and the signal that ended it); nothing while it runs. Never waits.
  std::optional<int> status();
  // Asks it to end (SIGTERM); who asks again has no patience (SIGKILL).
  void stop();
  bool was_stopped() const { return stopped_; }
  // The last that it said.
  std::string said() const;

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  ChildProcess(pid_t process, File said) : process_(process), said_(std::move(said)) {}

  pid_t process_;
  File said_;
  std::optional<int> status_;
  bool stopped_ = false;
};

}  // namespace rayloc
