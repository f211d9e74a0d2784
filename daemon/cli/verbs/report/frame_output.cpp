#include "daemon/cli/verbs/report/frame_output.h"

#include <iterator>

#include "daemon/base/arrays/npz_file.h"
#include "daemon/lab/recordings/frame_arrays.h"
#include "daemon/lab/recordings/frame_lines.h"

namespace rayloc::cli {
namespace {

tl::unexpected<Error> unwritable_output() {
  return make_error(ErrorKind::kUnavailable, "the output cannot be written");
}

}  // namespace

Expected<FrameOutput> FrameOutput::open(const FrameOutputOptions& options) {
  if (options.file.empty() || is_npz(options.file)) {
    return FrameOutput(options, File(stdout, [](std::FILE*) { return 0; }));
  }
  File file(std::fopen(options.file.c_str(), "w"), std::fclose);
  if (file == nullptr) {
    return make_error(ErrorKind::kUnavailable,
                      options.file + ": cannot be written; choose another --out");
  }
  return FrameOutput(options, std::move(file));
}

std::size_t FrameOutput::add_access_point(const std::string& name) {
  access_points_.push_back(name);
  return access_points_.size() - 1;
}

Expected<void> FrameOutput::write_line(const std::string& line) {
  if (std::fputs(line.c_str(), out_.get()) < 0 || std::fputc('\n', out_.get()) == EOF) {
    return unwritable_output();
  }
  return {};
}

Expected<void> FrameOutput::write(std::vector<CsiFrame>& frames, const std::string& access_point) {
  if (is_npz(options_.file)) {
    std::move(frames.begin(), frames.end(), std::back_inserter(frames_));
    return {};
  }
  for (const CsiFrame& frame : frames) {
    RAYLOC_TRY(write_line(is_json() ? frame_json(frame, access_point, options_.values)
                                    : frame_text(frame, access_point)));
  }
  return std::fflush(out_.get()) == 0 ? Expected<void>() : unwritable_output();
}

Expected<void> FrameOutput::write_arrays() const {
  if (!is_npz(options_.file)) {
    return {};
  }
  return write_npz(frame_arrays(frames_), access_points_, options_.file);
}

Expected<void> FrameOutput::write_summary(const FrameSummary& summary) {
  return write_line(is_json() ? summary_json(summary) : summary_text(summary));
}

}  // namespace rayloc::cli
