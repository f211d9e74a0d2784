#include "tests/e2e/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "tests/support/test_paths.h"

namespace rayloc::e2e {

namespace {

constexpr int kFirstPassedSocket = 3;

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> list;
  list.reserve(words.size() + 1);
  for (std::string& word : words) {
    list.push_back(word.data());
  }
  list.push_back(nullptr);
  return list;
}

std::vector<std::string> command_line(const std::string& file,
                                      const std::vector<std::string>& arguments,
                                      const ProcessSetting& setting) {
  // A test that dies takes its processes along.
  std::vector<std::string> words = {"setpriv", "--pdeathsig", "KILL", "--"};
  words.insert(words.end(), setting.wrapper.begin(), setting.wrapper.end());
  if (!setting.sockets.empty()) {
    // sd_listen_fds(3) wants to be sure that the sockets are for this very process.
    for (const char* word : {"/bin/sh", "-c", R"(LISTEN_PID=$$ exec "$0" "$@")"}) {
      words.emplace_back(word);
    }
  }
  words.push_back(file);
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

std::vector<std::string> environment_of(const ProcessSetting& setting) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    all.emplace_back(*entry);
  }
  all.insert(all.end(), setting.environment.begin(), setting.environment.end());
  if (!setting.sockets.empty()) {
    std::string names;
    for (const auto& [name, fd] : setting.sockets) {
      names += (names.empty() ? "" : ":") + name;
    }
    all.push_back("LISTEN_FDS=" + std::to_string(setting.sockets.size()));
    all.push_back("LISTEN_FDNAMES=" + names);
  }
  return all;
}

bool is_crash(int signal) {
  return signal == SIGSEGV || signal == SIGABRT || signal == SIGBUS || signal == SIGFPE ||
         signal == SIGILL;
}

}  // namespace

Process::Process(const std::filesystem::path& folder,
                 const std::string& name,
                 const std::string& program,
                 const std::vector<std::string>& arguments,
                 const ProcessSetting& setting)
    : out_(folder / (name + ".out")), err_(folder / (name + ".err")) {
  const std::string file = test::program_path(program);
  std::vector<std::string> words = command_line(file, arguments, setting);
  std::vector<std::string> environment = environment_of(setting);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, 1, out_.c_str(), kFlags, 0644);
  posix_spawn_file_actions_addopen(&actions, 2, err_.c_str(), kFlags, 0644);
  // First out of the way of one another, then to their places.
  std::vector<int> copies;
  for (const auto& [socket, fd] : setting.sockets) {
    copies.push_back(fcntl(fd, F_DUPFD_CLOEXEC, 100));
  }
  for (std::size_t i = 0; i < copies.size(); ++i) {
    posix_spawn_file_actions_adddup2(&actions, copies[i], kFirstPassedSocket + static_cast<int>(i));
  }
  const int error = posix_spawnp(&pid_,
                                 words.front().c_str(),
                                 &actions,
                                 nullptr,
                                 pointers(words).data(),
                                 pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  for (const int copy : copies) {
    close(copy);
  }
  if (error != 0) {
    pid_ = -1;
    throw std::system_error(error, std::generic_category(), words.front());
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
  // A crash is a defect, which the gate does not repeat (tests/gate/flakes.py).
  if (WIFSIGNALED(raw) && is_crash(WTERMSIG(raw))) {
    std::cerr << err_.stem().string() << ": ended by signal " << WTERMSIG(raw) << '\n';
  }
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

}  // namespace rayloc::e2e
