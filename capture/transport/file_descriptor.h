// Owns a file descriptor.
#pragma once

#include <unistd.h>

#include <utility>

namespace rayloc {

class FileDescriptor {
 public:
  // A negative descriptor, as of a failed call, is not closed.
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() {
    if (fd_ >= 0) {
      close(fd_);
    }
  }
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;

  int get() const { return fd_; }

 private:
  int fd_;
};

}  // namespace rayloc
