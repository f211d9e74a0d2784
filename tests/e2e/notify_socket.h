// NotifySocket: the service manager's end of sd_notify(3), for tests of a process.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace rayloc::e2e {

class NotifySocket {
 public:
  // Makes the socket `folder`/notify.
  explicit NotifySocket(const std::filesystem::path& folder);
  ~NotifySocket();
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  // For ProcessSetting::environment.
  std::string variable() const { return "NOTIFY_SOCKET=" + path_.string(); }
  // The lines ("READY=1") of all messages so far, in order; until the next call, which appends.
  const std::vector<std::string>& lines();
  int count(const std::string& line);
  // Waits until a message has the line `count` times in all.
  bool wait_for(const std::string& line, std::chrono::seconds patience, int count = 1);

 private:
  std::filesystem::path path_;
  int socket_;
  std::vector<std::string> lines_;
};

}  // namespace rayloc::e2e
