// A library to be preloaded into raylocd, with which a test sets the machine's clock as this one
// process sees it: CLOCK_REALTIME, and the kernel's time stamps of datagrams. The file that
// RAYLOC_CLOCK_SHIM names holds by how many nanoseconds, as an int64.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t offset() {
  static const auto* const kShared = [] {
    const int fd = open(std::getenv("RAYLOC_CLOCK_SHIM"), O_RDONLY | O_CLOEXEC);
    void* const page = mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, fd, 0);
    return static_cast<const std::atomic<std::int64_t>*>(page);
  }();
  return kShared->load();
}

void shift(timespec& time) {
  std::int64_t nanoseconds = time.tv_nsec + offset() % kSecond;
  time.tv_sec += offset() / kSecond;
  time.tv_sec += nanoseconds < 0 ? -1 : nanoseconds / kSecond;
  nanoseconds += nanoseconds < 0 ? kSecond : 0;
  time.tv_nsec = nanoseconds % kSecond;
}

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const int result = real<int(clockid_t, timespec*)>("clock_gettime")(clock, time);
  if (result == 0 && clock == CLOCK_REALTIME) {
    shift(*time);
  }
  return result;
}

extern "C" int recvmmsg(int fd, mmsghdr* messages, unsigned count, int flags, timespec* timeout) {
  const int got = real<int(int, mmsghdr*, unsigned, int, timespec*)>("recvmmsg")(
      fd, messages, count, flags, timeout);
  for (int i = 0; i < got; ++i) {
    msghdr& message = messages[i].msg_hdr;
    for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
      if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_TIMESTAMPNS) {
        timespec stamp{};
        std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
        shift(stamp);
        std::memcpy(CMSG_DATA(c), &stamp, sizeof stamp);
      }
    }
  }
  return got;
}
