// AppendProcess: a small process that appends to a file on behalf of this one, so that a SIGKILL at
// any instant leaves whole appends only.
//
// write(2) alone does not guarantee that: the kernel checks for a fatal signal before each page it
// copies (generic_perform_write) and stops between two pages. Measured with a process that only
// writes: 8 to 32 of 100 SIGKILLs left a torn end. The process receives each append as one message,
// whole or not at all, completes it when its parent has ended, and exits. (A SIGKILL of the whole
// control group can still interrupt a write.)
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <span>

#include "engine/base/expected.h"

namespace rayloc {

class AppendProcess {
 public:
  // Maximum append; a record with the longest UDP datagram has 65,565 bytes.
  static constexpr std::size_t kMaxBytes = std::size_t{96} << 10;

  // `file` is open for appending and remains owned by the caller.
  static Expected<AppendProcess> start(int file);
  // Waits for the process to end.
  ~AppendProcess();
  AppendProcess(AppendProcess&& other) noexcept;
  AppendProcess& operator=(AppendProcess&& other) noexcept;

  // Further appends go to this file, which remains owned by the caller; returns 0 or errno.
  int use(int file) const;

  // Returns 0, or errno: none of `bytes` is in the file then.
  int append(std::span<const std::byte> bytes) const;

 private:
  AppendProcess(int socket, pid_t process) : socket_(socket), process_(process) {}
  void end();
  int answer() const;

  int socket_;
  pid_t process_;
};

}  // namespace rayloc
