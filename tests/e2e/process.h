// Process: a program of this project run as a real process, for end-to-end tests. Its standard
// output and error go to files; the destructor kills what still runs, so no test leaves one behind.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/eventually.h"

namespace rayloc::e2e {

// Settings of a process besides its arguments.
struct ProcessSetting {
  std::vector<std::string> environment = {};  // "NAME=VALUE", added to ours
  // Sockets that it finds as systemd passes them (sd_listen_fds(3)), with their names.
  std::vector<std::pair<std::string, int>> sockets = {};
  std::vector<std::string> wrapper = {};  // words in front of the program: {"unshare", "--net"}
};

class Process {
 public:
  // `name` names the output files in `folder`: NAME.out, NAME.err. `program` is a file of the
  // build's bin/ folder.
  Process(const std::filesystem::path& folder,
          const std::string& name,
          const std::string& program,
          const std::vector<std::string>& arguments,
          const ProcessSetting& setting = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool running();
  void signal(int number);
  // The exit status, 128 + signal for a killed one; nothing if it still runs after `patience`.
  std::optional<int> wait(std::chrono::seconds patience);

  pid_t pid() const { return pid_; }
  const std::filesystem::path& out() const { return out_; }
  // Its standard error, for the message of a failure.
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

}  // namespace rayloc::e2e
