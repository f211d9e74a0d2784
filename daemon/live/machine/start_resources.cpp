#include "daemon/live/machine/start_resources.h"

#include <sys/eventfd.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "capture/transport/file_descriptor.h"
#include "daemon/base/exit_status.h"

namespace rayloc {
namespace {

// Queues, batches and mappings of libraries, beyond the stacks of threads and their heaps.
constexpr std::size_t kSpareBytes = std::size_t{32} << 20U;

const char* const kMemoryAdvice =
    "; raise the limit of memory (ulimit -v, MemoryMax=), of processes (ulimit -u, TasksMax=) or "
    "give the machine more";
const char* const kDescriptorAdvice = "; raise the limit of descriptors (ulimit -n, LimitNOFILE=)";

tl::unexpected<Error> lack(const std::string& of, int number, const char* advice) {
  return make_error(ErrorKind::kUnavailable,
                    "cannot start: no " + of + ": " + std::strerror(number) + advice);
}

// Threads that have each begun a separate heap and wait to be released.
class TrialThreads {
 public:
  explicit TrialThreads(std::size_t count) { threads_.reserve(count); }
  ~TrialThreads() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) {
      thread.join();
    }
  }
  TrialThreads(const TrialThreads&) = delete;
  TrialThreads& operator=(const TrialThreads&) = delete;

  // Returns when the thread has begun; throws std::system_error or std::bad_alloc.
  void add() {
    threads_.emplace_back([this] { wait(); });
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return begun_ == threads_.size(); });
  }

 private:
  void wait() {
    const auto of_its_heap = std::make_unique<std::string>(1024, '\0');
    std::unique_lock lock(mutex_);
    ++begun_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return over_; });
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t begun_ = 0;  // guarded by mutex_
  bool over_ = false;      // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace

Expected<void> check_start_resources(std::size_t threads, std::size_t descriptors) {
  std::vector<FileDescriptor> opened;
  opened.reserve(descriptors);
  while (opened.size() < descriptors) {
    opened.emplace_back(eventfd(0, EFD_CLOEXEC));
    if (opened.back().get() < 0) {
      return lack(std::to_string(descriptors) + " descriptors for sources, sockets and clients",
                  errno,
                  kDescriptorAdvice);
    }
  }
  const std::string wanted = "memory for " + std::to_string(threads) + " threads";
  try {
    TrialThreads trial(threads);
    for (std::size_t i = 0; i < threads; ++i) {
      trial.add();
    }
    const std::unique_ptr<char[]> spare(new char[kSpareBytes]);  // NOLINT: never touched
  } catch (const std::system_error& error) {
    return lack(wanted, error.code().value(), kMemoryAdvice);
  } catch (const std::bad_alloc&) {
    return lack(wanted, ENOMEM, kMemoryAdvice);
  }
  return {};
}

std::size_t affordable_connections(std::size_t most) {
  rlimit descriptors{};
  if (getrlimit(RLIMIT_NOFILE, &descriptors) != 0 || descriptors.rlim_cur == RLIM_INFINITY) {
    return most;
  }
  return std::clamp<std::size_t>(descriptors.rlim_cur / 4, 1, most);
}

FatalMessage fatal_message(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    return {std::string("out of memory") + kMemoryAdvice, exit_status(ErrorKind::kUnavailable)};
  }
  if (const auto* system = dynamic_cast<const std::system_error*>(&error); system != nullptr) {
    const int number = system->code().value();
    if (number == EAGAIN || number == ENOMEM) {
      return {std::string("no memory for a thread: ") + error.what() + kMemoryAdvice,
              exit_status(ErrorKind::kUnavailable)};
    }
    if (number == EMFILE || number == ENFILE) {
      return {std::string("no descriptor: ") + error.what() + kDescriptorAdvice,
              exit_status(ErrorKind::kUnavailable)};
    }
  }
  return {std::string("internal error: ") + error.what(), kExitInternal};
}

void report_uncaught_exceptions() {
  std::set_terminate([] {
    if (const std::exception_ptr thrown = std::current_exception()) {
      try {
        std::rethrow_exception(thrown);
      } catch (const std::exception& error) {
        const FatalMessage message = fatal_message(error);
        std::fprintf(stderr, "raylocd: %s\n", message.text.c_str());
        if (message.exit_status != kExitInternal) {
          std::_Exit(message.exit_status);
        }
      } catch (...) {
        std::fprintf(stderr, "raylocd: internal error: an unknown exception\n");
      }
    }
    std::abort();
  });
}

}  // namespace rayloc
