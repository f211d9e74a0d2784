#include "daemon/base/output_file.h"

#include <cerrno>
#include <cstring>

namespace rayloc {

Expected<OutputFile> OutputFile::open(const std::string& path) {
  if (path == "-") {
    return OutputFile("standard output", stdout);
  }
  std::FILE* file = std::fopen(path.c_str(), "wbe");
  if (file == nullptr) {
    return make_error(ErrorKind::kUnavailable,
                      path + ": cannot be written: " + std::strerror(errno));
  }
  return OutputFile(path, file);
}

void OutputFile::write(std::string_view bytes) {
  failed_ |= std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size();
  if (file_.get() == stdout) {
    failed_ |= std::fflush(stdout) != 0;
  }
}

Expected<void> OutputFile::close() {
  std::FILE* file = file_.release();
  const bool closed = file == stdout ? std::fflush(file) == 0 : std::fclose(file) == 0;
  if (failed_ || !closed) {
    return make_error(ErrorKind::kUnavailable, path_ + ": not everything could be written");
  }
  return {};
}

}  // namespace rayloc
