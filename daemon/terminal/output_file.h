// OutputFile: where a verb writes its data: a file, or standard output for "-". Errors of writing
// (disk full, reader gone) are kept and told at close().
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace rayloc::cli {

class OutputFile {
 public:
  static Expected<OutputFile> open(const std::string& path);

  // Text reaches a terminal or a pipe at once; a file when its buffer is full.
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

}  // namespace rayloc::cli
