// Makes a process end with its parent, however the parent ended.
#pragma once

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>

namespace rayloc {

// The kernel kills this process when the thread that created it has ended (prctl(2)). To be called
// between fork() and exec() as well: async-signal-safe. False if that parent has already ended, or
// the kernel denies it.
inline bool end_with_parent(pid_t parent) {
  return prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() == parent;
}

}  // namespace rayloc
