#include "daemon/live/studio/child_process.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "daemon/live/machine/end_with_parent.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr int kNiceness = 10;                     // chosen: for work that is not time-critical
constexpr off_t kMaxErrorBytes = off_t{1} << 16;  // [bytes], chosen: end of its standard error
constexpr std::string_view kFirstToGo = "1000";   // for oom_score_adj: proc(5)
constexpr std::string_view kNotStarted = "the program cannot be started\n";
constexpr std::string_view kNotLimited = "the limits of the program cannot be set\n";

// Copies of the standard descriptors of the process, above those that they become.
class Descriptors {
 public:
  Descriptors(const ChildSettings& settings, int errors) {
    const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
    copies_ = {copy_of(settings.input < 0 ? nothing : settings.input),
               copy_of(settings.output < 0 ? nothing : settings.output),
               copy_of(errors)};
    if (nothing >= 0) {
      close(nothing);
    }
  }
  ~Descriptors() {
    for (const int fd : copies_) {
      if (fd >= 0) {
        close(fd);
      }
    }
  }
  Descriptors(const Descriptors&) = delete;
  Descriptors& operator=(const Descriptors&) = delete;

  bool are_open() const {
    return std::all_of(copies_.begin(), copies_.end(), [](int fd) { return fd >= 0; });
  }
  // In the process itself: async-signal-safe.
  bool become_standard() const {
    for (std::size_t fd = 0; fd < copies_.size(); ++fd) {
      if (dup2(copies_[fd], static_cast<int>(fd)) < 0) {
        return false;
      }
    }
    return close_range(STDERR_FILENO + 1, ~0U, 0) == 0;
  }

 private:
  static int copy_of(int fd) { return fd < 0 ? -1 : fcntl(fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1); }

  std::array<int, 3> copies_{};  // by the descriptor that each becomes
};

// Async-signal-safe: in the GNU C library getrlimit() and setrlimit() are system calls alone. A
// limit that this process has itself is never raised.
bool set_limit(decltype(RLIMIT_AS) resource, std::uint64_t limit) {
  rlimit both{};
  if (limit == 0) {
    return true;
  }
  if (getrlimit(resource, &both) != 0) {
    return false;
  }
  both.rlim_max = std::min<rlim_t>(both.rlim_max, limit + 1);  // a second later: SIGKILL
  both.rlim_cur = std::min({both.rlim_cur, both.rlim_max, rlim_t{limit}});
  return setrlimit(resource, &both) == 0;
}

// Async-signal-safe. A core file would exceed the limits of memory and of files.
bool set_limits(const ChildSettings& settings) {
  const rlimit none{};
  const bool is_limited =
      settings.processor_seconds > 0 || settings.file_bytes > 0 || settings.memory_bytes > 0;
  return (!is_limited || setrlimit(RLIMIT_CORE, &none) == 0) &&
         set_limit(RLIMIT_CPU, settings.processor_seconds) &&
         set_limit(RLIMIT_FSIZE, settings.file_bytes) &&
         set_limit(RLIMIT_AS, settings.memory_bytes);
}

[[noreturn]] void end_with(std::string_view message) {
  if (write(STDERR_FILENO, message.data(), message.size()) < 0) {
    _exit(ChildProcess::kCannotStart + 1);
  }
  _exit(ChildProcess::kCannotStart);
}

// The parent has threads: between fork() and execv() only async-signal-safe calls are allowed.
[[noreturn]] void become(char* const* arguments,
                         const Descriptors& descriptors,
                         const ChildSettings& settings,
                         pid_t parent) {
  for (int signal = 1; signal < NSIG; ++signal) {
    std::signal(signal, SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);  // Ctrl-C goes to the parent only, which decides
  if (!end_with_parent(parent)) {
    _exit(ChildProcess::kCannotStart);
  }
  if (nice(kNiceness) < 0) {  // which the systemd unit of raylocd forbids
    const sched_param idle{};
    sched_setscheduler(0, SCHED_IDLE, &idle);
  }
  // Makes this process the first to be killed if memory runs out. close_range() below closes it.
  const int score = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (score >= 0 && write(score, kFirstToGo.data(), kFirstToGo.size()) < 0) {
    close(score);
  }
  if (!descriptors.become_standard()) {
    _exit(ChildProcess::kCannotStart);
  }
  if (!set_limits(settings)) {
    end_with(kNotLimited);
  }
  execv(arguments[0], arguments);
  end_with(kNotStarted);
}

tl::unexpected<Error> cannot_start(const fs::path& program, int error) {
  return make_error(ErrorKind::kUnavailable,
                    "cannot start " + program.string() + ": " + std::strerror(error));
}

}  // namespace

Expected<fs::path> rayloc_program() {
  std::error_code failed;
  const fs::path folder = fs::read_symlink("/proc/self/exe", failed).parent_path();
  for (const fs::path& one : {folder / "rayloc", folder.parent_path() / "bin" / "rayloc"}) {
    if (access(one.c_str(), X_OK) == 0) {
      return one;
    }
  }
  return make_error(ErrorKind::kUnavailable,
                    "there is no program rayloc in " + folder.string() + " or " +
                        (folder.parent_path() / "bin").string() + "; install it");
}

Expected<std::unique_ptr<ChildProcess>> ChildProcess::start(
    const fs::path& program,
    const std::vector<std::string>& arguments,
    const ChildSettings& settings) {
  std::signal(SIGCHLD, SIG_DFL);  // an inherited SIG_IGN would make waitpid() fail
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  File errors(std::tmpfile(), &std::fclose);
  if (!errors) {
    return cannot_start(program, errno);
  }
  const Descriptors descriptors(settings, fileno(errors.get()));
  const pid_t parent = getpid();
  const pid_t process = descriptors.are_open() ? fork() : -1;
  if (process == 0) {
    become(pointers.data(), descriptors, settings, parent);
  }
  const int error = errno;
  if (process < 0) {
    return cannot_start(program, error);
  }
  return std::unique_ptr<ChildProcess>(new ChildProcess(process, std::move(errors)));
}

ChildProcess::~ChildProcess() {
  if (!status()) {
    kill(process_, SIGKILL);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
}

std::optional<int> ChildProcess::status() {
  int status = 0;
  const pid_t ended = status_ ? 0 : waitpid(process_, &status, WNOHANG);
  if (ended == process_) {
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : kBySignal + WTERMSIG(status);
  } else if (ended < 0 && errno == ECHILD) {
    status_ = kCannotStart;  // it has ended, with an unknown status
  }
  return status_;
}

void ChildProcess::stop() {
  if (!status()) {
    kill(process_, stopped_ ? SIGKILL : SIGTERM);
    stopped_ = true;
  }
}

std::string ChildProcess::errors() const {
  const int file = fileno(errors_.get());
  struct stat known {};  // the offset is shared with the process: no seek
  const off_t end = fstat(file, &known) == 0 ? known.st_size : 0;
  const off_t begin = std::max<off_t>(0, end - kMaxErrorBytes);
  std::string text(static_cast<std::size_t>(end - begin), '\0');
  const ssize_t got = pread(file, text.data(), text.size(), begin);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
  return text;
}

}  // namespace rayloc
