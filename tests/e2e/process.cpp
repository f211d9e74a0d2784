#include "tests/e2e/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace rayloc::e2e {

Process::Process(const std::filesystem::path& folder,
                 const std::string& name,
                 const std::string& program,
                 const std::vector<std::string>& arguments)
    : out_(folder / (name + ".out")), err_(folder / (name + ".err")) {
  const std::string file = std::string(RAYLOC_BIN) + "/" + program;
  std::vector<std::string> words{file};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, 1, out_.c_str(), kFlags, 0644);
  posix_spawn_file_actions_addopen(&actions, 2, err_.c_str(), kFlags, 0644);
  const int error = posix_spawn(&pid_, file.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    pid_ = -1;
    throw std::system_error(error, std::generic_category(), file);
  }
}

Process::~Process() {
  if (running()) {
    signal(SIGKILL);
    reap(0);
  }
}

void Process::reap(int options) {
  int raw = 0;
  if (status_ || pid_ < 0 || waitpid(pid_, &raw, options) != pid_) {
    return;
  }
  status_ = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
}

bool Process::running() {
  reap(WNOHANG);
  return pid_ >= 0 && !status_;
}

void Process::signal(int number) {
  if (running()) {
    kill(pid_, number);
  }
}

std::optional<int> Process::wait(std::chrono::seconds patience) {
  eventually(patience, [this] { return !running(); });
  return status_;
}

std::string Process::errors() const { return err_.filename().string() + ":\n" + read_text(err_); }

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> read_lines(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
  }
  return lines;
}

void pause_briefly() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

}  // namespace rayloc::e2e
