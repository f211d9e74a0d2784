#include "capture/record/append_process.h"

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

// Descriptors of the process. They are not standard ones, which are closed: output of any code in
// it to those, e.g. of a sanitizer that flushes the parent's buffers in _exit(), must not become
// part of the recording.
constexpr int kSocket = 3;
constexpr int kFile = 4;

// Returns 0 or errno; a partial write is undone.
int append_whole(const std::byte* bytes, std::size_t size) {
  const off_t before = lseek(kFile, 0, SEEK_END);
  const ssize_t written = write(kFile, bytes, size);
  if (written == static_cast<ssize_t>(size)) {
    return 0;
  }
  if (written < 0) {
    return errno;
  }
  // A partial write occurs only if the file may not grow any more.
  return ftruncate(kFile, before) == 0 ? ENOSPC : errno;
}

// Buffer for one descriptor passed with a message.
struct Passed {
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(int))> bytes{};
};

// Returns 0 or errno for a message that passes the next file.
int take_file(const cmsghdr& control) {
  int file = -1;
  std::memcpy(&file, CMSG_DATA(&control), sizeof file);
  const int result = dup2(file, kFile) == kFile ? 0 : errno;
  close(file);
  return result;
}

[[noreturn]] void serve() {
  std::array<std::byte, AppendProcess::kMaxBytes> buffer;
  while (true) {
    Passed passed;
    iovec bytes{.iov_base = buffer.data(), .iov_len = buffer.size()};
    msghdr message{};
    message.msg_iov = &bytes;
    message.msg_iovlen = 1;
    message.msg_control = passed.bytes.data();
    message.msg_controllen = passed.bytes.size();
    const ssize_t got = recvmsg(kSocket, &message, 0);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      _exit(0);  // the parent has ended
    }
    const cmsghdr* const control = CMSG_FIRSTHDR(&message);
    const int result = control != nullptr
                           ? take_file(*control)
                           : append_whole(buffer.data(), static_cast<std::size_t>(got));
    send(kSocket, &result, sizeof result, MSG_NOSIGNAL);
  }
}

// Keeps none of the parent's descriptors but the two, which are above kFile: not its ports, and not
// the pipes whose end others wait for. Only the parent ends the process, not a Ctrl-C.
[[noreturn]] void become_writer(int socket, int file) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXFSZ}) {
    std::signal(signal, SIG_IGN);
  }
  prctl(PR_SET_NAME, "rayloc-append");
  if (dup2(socket, kSocket) != kSocket || dup2(file, kFile) != kFile ||
      close_range(0, kSocket - 1, 0) != 0 || close_range(kFile + 1, ~0U, 0) != 0) {
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

AppendProcess::~AppendProcess() { end(); }

AppendProcess& AppendProcess::operator=(AppendProcess&& other) noexcept {
  if (this != &other) {
    end();
    socket_ = std::exchange(other.socket_, -1);
    process_ = std::exchange(other.process_, -1);
  }
  return *this;
}

void AppendProcess::end() {
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
  return done < 0 ? errno : answer();
}

int AppendProcess::use(int file) const {
  std::byte one{};
  iovec bytes{.iov_base = &one, .iov_len = 1};
  Passed passed;
  msghdr message{};
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = passed.bytes.data();
  message.msg_controllen = passed.bytes.size();
  cmsghdr* const control = CMSG_FIRSTHDR(&message);
  control->cmsg_level = SOL_SOCKET;
  control->cmsg_type = SCM_RIGHTS;
  control->cmsg_len = CMSG_LEN(sizeof file);
  std::memcpy(CMSG_DATA(control), &file, sizeof file);
  ssize_t done = 0;
  do {
    done = sendmsg(socket_, &message, MSG_NOSIGNAL);
  } while (done < 0 && errno == EINTR);
  return done < 0 ? errno : answer();
}

// The reply of the process to the last message: 0 or errno.
int AppendProcess::answer() const {
  int result = 0;
  ssize_t got = 0;
  do {
    got = recv(socket_, &result, sizeof result, 0);
  } while (got < 0 && errno == EINTR);
  if (got == 0) {
    return EPIPE;  // the process was killed
  }
  return got < 0 ? errno : result;
}

}  // namespace rayloc
