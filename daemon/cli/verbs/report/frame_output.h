// FrameOutput: writes the frames of recordings as lines of text or as arrays of numpy.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/lab/recordings/frame_summary.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc::cli {

struct FrameOutputOptions {
  std::string file;     // empty: standard output; FILE.npz: arrays, and the summary as text
  bool json = false;    // lines of JSON
  bool values = false;  // with tone_index and csi; implies JSON
};

// Errors are of kind kUnavailable. Thread safety: none.
class FrameOutput {
 public:
  static Expected<FrameOutput> open(const FrameOutputOptions& options);

  // Returns the number of the access point, for CsiFrame::access_point.
  std::size_t add_access_point(const std::string& name);
  // Lines are flushed, for a concurrent reader. Arrays keep the frames, which are moved.
  Expected<void> write(std::vector<CsiFrame>& frames, const std::string& access_point);
  // Writes the arrays, if the output has any, once all frames are read.
  Expected<void> write_arrays() const;
  Expected<void> write_summary(const FrameSummary& summary);

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

  FrameOutput(const FrameOutputOptions& options, File out)
      : options_(options), out_(std::move(out)) {}
  bool is_json() const { return options_.json || options_.values; }
  Expected<void> write_line(const std::string& line);

  FrameOutputOptions options_;
  File out_;
  std::vector<CsiFrame> frames_;  // for arrays
  std::vector<std::string> access_points_;
};

}  // namespace rayloc::cli
