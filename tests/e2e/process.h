// Process: a program of this project run as a real process, for end-to-end tests. Its standard
// output and error go to files; the destructor kills what still runs, so no test leaves one behind.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rayloc::e2e {

class Process {
 public:
  // `name` names the output files in `folder`: NAME.out, NAME.err. `program` is a file of the
  // build's bin/ folder.
  Process(const std::filesystem::path& folder,
          const std::string& name,
          const std::string& program,
          const std::vector<std::string>& arguments);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool running();
  void signal(int number);
  // The exit status, 128 + signal for a killed one; nothing when it still runs after `patience`.
  std::optional<int> wait(std::chrono::seconds patience);

  pid_t pid() const { return pid_; }
  const std::filesystem::path& out() const { return out_; }
  // What it said, for the message of a failure.
  std::string errors() const;

 private:
  void reap(int options);

  std::filesystem::path out_;
  std::filesystem::path err_;
  pid_t pid_ = -1;
  std::optional<int> status_;
};

std::string read_text(const std::filesystem::path& file);
std::vector<std::string> read_lines(const std::filesystem::path& file);

// Calls `condition` every few milliseconds until it holds. False when `patience` has run out.
template <typename Condition>
bool eventually(std::chrono::seconds patience, Condition condition);

void pause_briefly();

template <typename Condition>
bool eventually(std::chrono::seconds patience, Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return false;
    }
    pause_briefly();
  }
  return true;
}

}  // namespace rayloc::e2e
