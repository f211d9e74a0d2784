// RaylocProcess: `rayloc` with arguments, as a separate process, for the tests of its verbs.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc {

struct Finished {
  int status = -1;
  std::string out;
  std::string err;
};

// wait() reads its output: until then it must fit into a pipe (64 KiB each).
class RaylocProcess {
 public:
  // `in`: the process's standard input.
  explicit RaylocProcess(std::vector<std::string> arguments, int in = STDIN_FILENO) {
    arguments.insert(arguments.begin(), test::program_path("rayloc"));
    EXPECT_EQ(::pipe(out_.data()), 0);
    EXPECT_EQ(::pipe(err_.data()), 0);
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) {
      argv.push_back(argument.data());
    }
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(in, STDIN_FILENO);
      ::dup2(out_[1], STDOUT_FILENO);
      ::dup2(err_[1], STDERR_FILENO);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    ::close(out_[1]);
    ::close(err_[1]);
  }

  void signal(int number) const { ::kill(pid_, number); }

  Finished wait() const {
    Finished finished;
    finished.out = read_all(out_[0]);
    finished.err = read_all(err_[0]);
    int status = 0;
    ::waitpid(pid_, &status, 0);
    finished.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return finished;
  }

 private:
  static std::string read_all(int descriptor) {
    std::string text;
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = ::read(descriptor, buffer.data(), buffer.size())) > 0;) {
      text.append(buffer.data(), static_cast<std::size_t>(n));
    }
    ::close(descriptor);
    return text;
  }

  std::array<int, 2> out_{};
  std::array<int, 2> err_{};
  pid_t pid_ = -1;
};

}  // namespace rayloc
