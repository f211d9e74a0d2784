// State of an interrupted joint calibration as a file, for --resume.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"
#include "engine/calibrate/joint/joint_calibration.h"

namespace rayloc {

inline constexpr const char* kCheckpointFile = "calibration.checkpoint.json";

struct StoredCheckpoint {
  JointCheckpoint reached;
  double seconds = 0.0;  // [s], wall-clock time of the method so far
};

// `inputs`: hash of all inputs of the calibration.
std::string to_json_text(const StoredCheckpoint& checkpoint, const std::string& inputs);

// Returns an Error if the file is missing, broken, or made from other inputs. `room`: start of the
// calibration; the number of values must match it.
Expected<StoredCheckpoint> load_checkpoint(const std::filesystem::path& file,
                                           const std::string& inputs,
                                           const RoomModel& room,
                                           std::size_t points);

}  // namespace rayloc
