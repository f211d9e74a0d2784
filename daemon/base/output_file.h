// OutputFile: the output of a verb: a file, or standard output for "-". Write errors (disk full,
// reader closed) are stored and reported by close().
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace rayloc {

class OutputFile {
 public:
  static Expected<OutputFile> open(const std::string& path);

  // Writes to a terminal or a pipe at once, to a file when its buffer is full.
  void write(std::string_view bytes);
  Expected<void> close();

 private:
  struct Close {
    void operator()(std::FILE* file) const {
      if (file != stdout) {
        std::fclose(file);
      }
    }
  };

  OutputFile(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}

  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  bool failed_ = false;
};

}  // namespace rayloc
