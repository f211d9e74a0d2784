#include "capture/append_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// The parent may have threads: between fork() and _exit() only async-signal-safe calls are allowed.

// Where the process keeps its two descriptors.
constexpr int kSocket = 0;
constexpr int kFile = 1;

// 0 or errno; a partial write is undone.
int append_whole(const std::byte* bytes, std::size_t size) {
  const off_t before = lseek(kFile, 0, SEEK_END);
  const ssize_t written = write(kFile, bytes, size);
  if (written == static_cast<ssize_t>(size)) {
    return 0;
  }
  if (written < 0) {
    return errno;
  }
  // Only a file that may not grow any more takes a part.
  return ftruncate(kFile, before) == 0 ? ENOSPC : errno;
}

[[noreturn]] void serve() {
  std::array<std::byte, AppendProcess::kMaxBytes> buffer;
  while (true) {
    const ssize_t got = recv(kSocket, buffer.data(), buffer.size(), 0);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      _exit(0);  // the parent is gone
    }
    const int result = append_whole(buffer.data(), static_cast<std::size_t>(got));
    send(kSocket, &result, sizeof result, MSG_NOSIGNAL);
  }
}

// Keeps nothing of the parent but the two descriptors, which lie above kFile: not its ports, and
// not the pipes whose end others wait for. The parent decides when it is over, not a Ctrl-C.
[[noreturn]] void become_writer(int socket, int file) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXFSZ}) {
    std::signal(signal, SIG_IGN);
  }
  prctl(PR_SET_NAME, "rayloc-append");
  if (dup2(socket, kSocket) != kSocket || dup2(file, kFile) != kFile ||
      close_range(kFile + 1, ~0U, 0) != 0) {
    _exit(1);
  }
  serve();
}

tl::unexpected<Error> cannot_start(int error) {
  return make_error(
      ErrorKind::kUnavailable,
      std::string("cannot start the process that writes a recording: ") + std::strerror(error));
}

}  // namespace

Expected<AppendProcess> AppendProcess::start(int file) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return cannot_start(errno);
  }
  // Above the places that the process will copy them to.
  const int its_end = fcntl(ends[1], F_DUPFD_CLOEXEC, kFile + 1);
  const int its_file = fcntl(file, F_DUPFD_CLOEXEC, kFile + 1);
  const pid_t process = its_end >= 0 && its_file >= 0 ? fork() : -1;
  if (process == 0) {
    become_writer(its_end, its_file);
  }
  const int error = errno;
  for (const int fd : {ends[1], its_end, its_file}) {
    if (fd >= 0) {
      close(fd);
    }
  }
  if (process < 0) {
    close(ends[0]);
    return cannot_start(error);
  }
  return AppendProcess(ends[0], process);
}

AppendProcess::AppendProcess(AppendProcess&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), process_(std::exchange(other.process_, -1)) {}

AppendProcess::~AppendProcess() {
  if (socket_ < 0) {
    return;
  }
  close(socket_);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

int AppendProcess::append(std::span<const std::byte> bytes) const {
  RAYLOC_CHECK(!bytes.empty() && bytes.size() <= kMaxBytes);
  ssize_t done = 0;
  do {
    done = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  } while (done < 0 && errno == EINTR);
  int result = 0;
  while (done >= 0) {
    done = recv(socket_, &result, sizeof result, 0);
    if (done == static_cast<ssize_t>(sizeof result)) {
      return result;
    }
    if (done == 0) {
      return EPIPE;  // somebody killed the process
    }
    done = errno == EINTR ? 0 : -1;
  }
  return errno;
}

}  // namespace rayloc
