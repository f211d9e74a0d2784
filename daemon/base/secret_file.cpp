#include "daemon/base/secret_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

namespace rayloc {

Expected<void> check_private(const std::filesystem::path& file, const KeyKind& kind) {
  struct stat status {};
  if (stat(file.c_str(), &status) == 0 && (status.st_mode & S_IRWXO) != 0) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() + ": everyone on this machine may use this " + kind.name +
                          "; take that away (chmod 600), and make a new one if others were here");
  }
  return {};
}

Expected<std::string> read_key_line(const std::filesystem::path& file, const KeyKind& kind) {
  std::ifstream in(file);
  if (!in) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() + ": the " + kind.name +
                          " cannot be read: " + std::strerror(errno) + "; " + kind.advice);
  }
  std::string line;
  std::getline(in, line);
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) {
    line.pop_back();
  }
  return line;
}

Expected<std::string> read_secret(const std::filesystem::path& file, const KeyKind& kind) {
  RAYLOC_TRY(check_private(file, kind));
  return read_key_line(file, kind);
}

Expected<void> write_secret(const std::filesystem::path& file, const std::string& secret) {
  const auto refuse = [&](int number) {
    return make_error(ErrorKind::kUnavailable,
                      file.string() + ": cannot be made: " + std::strerror(number));
  };
  const int fd = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (fd < 0) {
    return refuse(errno);
  }
  const std::string line = secret + "\n";
  const bool written =
      write(fd, line.data(), line.size()) == static_cast<ssize_t>(line.size()) && fsync(fd) == 0;
  const int number = errno;
  close(fd);
  if (!written) {
    unlink(file.c_str());
    return refuse(number);
  }
  return {};
}

}  // namespace rayloc
