#include "daemon/site/survey/survey_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "daemon/site/survey/csv_table.h"

namespace rayloc {
namespace {

constexpr const char* kHeader = "t_start,t_end,x,y,z\n";

Error cannot_write(const std::string& path) {
  return {ErrorKind::kUnavailable, path + ": cannot be written: " + std::strerror(errno)};
}

// Appends whole lines by one write(2) each, then syncs to the disk.
Expected<void> append_text(const std::string& path, const std::string& text) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor < 0) {
    return tl::make_unexpected(cannot_write(path));
  }
  const ssize_t count = ::write(descriptor, text.data(), text.size());
  const bool written = count == static_cast<ssize_t>(text.size()) && ::fsync(descriptor) == 0;
  const Error error = cannot_write(path);
  ::close(descriptor);
  return written ? Expected<void>() : tl::make_unexpected(error);
}

// In microseconds, the resolution of recordings.
std::string seconds_text(Timestamp time) {
  const auto microseconds =
      std::chrono::floor<std::chrono::microseconds>(time.time_since_epoch()).count();
  std::array<char, 40> text{};
  std::snprintf(text.data(),
                text.size(),
                "%lld.%06lld",
                static_cast<long long>(microseconds / 1'000'000),   // NOLINT(google-runtime-int)
                static_cast<long long>(microseconds % 1'000'000));  // NOLINT(google-runtime-int)
  return text.data();
}

bool ends_with_a_line(const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "rbe");
  if (file == nullptr) {
    return false;
  }
  const bool whole = std::fseek(file, -1, SEEK_END) == 0 && std::fgetc(file) == '\n';
  std::fclose(file);
  return whole;
}

}  // namespace

Expected<SurveyFile> SurveyFile::open(const std::string& path) {
  std::error_code ignored;  // the later read or write reports the error
  if (!std::filesystem::exists(path, ignored) || std::filesystem::file_size(path, ignored) == 0) {
    RAYLOC_TRY(append_text(path, kHeader));
    return SurveyFile(path, {});
  }
  const auto table = CsvTable::load(path);
  RAYLOC_TRY(table);
  auto points = read_points(*table);
  RAYLOC_TRY(points);
  const auto first = table->require({"t_start", "t_end", "x", "y", "z"});
  if (!ends_with_a_line(path) || table->separator() != ',' ||
      *first != std::vector<std::size_t>{0, 1, 2, 3, 4}) {
    return bad_input(path +
                     ": cannot be continued: rows must end with a new line and begin with "
                     "t_start,t_end,x,y,z, in commas; write to another file");
  }
  return SurveyFile(path, *std::move(points));
}

Expected<void> SurveyFile::append(const SurveyPoint& point) {
  std::array<char, 96> place{};
  std::snprintf(place.data(),
                place.size(),
                ",%.4f,%.4f,%.4f\n",
                point.position.x,
                point.position.y,
                point.position.z);
  auto written = append_text(
      path_, seconds_text(point.t_start) + "," + seconds_text(point.t_end) + place.data());
  if (written) {
    points_.push_back(point);
  }
  return written;
}

}  // namespace rayloc
