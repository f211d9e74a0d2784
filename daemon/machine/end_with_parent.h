// A process that ends with the one that made it, however that went.
#pragma once

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>

namespace rayloc {

// The kernel kills this process when the thread that made it is gone (prctl(2)). Between fork() and
// exec() as well: async-signal-safe. False where that parent has gone already, or the kernel denies
// it.
inline bool end_with_parent(pid_t parent) {
  return prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() == parent;
}

}  // namespace rayloc
