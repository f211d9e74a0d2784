// AppendProcess: a small process that appends to a file on behalf of this one, so that a SIGKILL at
// any instant leaves whole appends only.
//
// write(2) alone does not give that: the kernel looks for a fatal signal before each page it copies
// (generic_perform_write) and stops between two pages. Measured with a process that does nothing
// but write: 8 to 32 of 100 SIGKILLs left a torn end. The process gets each append as one message,
// so it has the whole of it or nothing, finishes what it has when its parent is gone, and exits.
// (A SIGKILL of the whole control group can still hit it in the midst of a write.)
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <span>

#include "engine/base/expected.h"

namespace rayloc {

class AppendProcess {
 public:
  // The longest append; a record with the longest UDP datagram has 65,565 bytes.
  static constexpr std::size_t kMaxBytes = std::size_t{96} << 10;

  // `file` is open for appending and stays the caller's.
  static Expected<AppendProcess> start(int file);
  // Waits for the process to end.
  ~AppendProcess();
  AppendProcess(AppendProcess&& other) noexcept;
  AppendProcess& operator=(AppendProcess&& other) noexcept;

  // From now on it appends to this file, which stays the caller's; 0 or errno.
  int use(int file) const;

  // 0, or the errno of what went wrong: nothing of `bytes` is in the file then.
  int append(std::span<const std::byte> bytes) const;

 private:
  AppendProcess(int socket, pid_t process) : socket_(socket), process_(process) {}
  void end();
  int answer() const;

  int socket_;
  pid_t process_;
};

}  // namespace rayloc
