// Where a joint calibration stood when it was interrupted, as a file, for --resume.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"
#include "engine/calibrate/joint/joint_calibration.h"

namespace rayloc {

inline constexpr const char* kCheckpointFile = "calibration.checkpoint.json";

struct StoredCheckpoint {
  JointCheckpoint reached;
  double seconds = 0.0;  // [s], wall clock that the method took so far
};

// `inputs`: hash of everything that the calibration starts from.
std::string to_json_text(const StoredCheckpoint& checkpoint, const std::string& inputs);

// An Error when the file is not there, is broken, or is of other inputs. `room`: what the
// calibration starts from; the numbers must be as many as it needs.
Expected<StoredCheckpoint> load_checkpoint(const std::filesystem::path& file,
                                           const std::string& inputs,
                                           const RoomModel& room,
                                           std::size_t points);

}  // namespace rayloc
