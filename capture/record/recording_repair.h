// Repairs the recording that a recorder left when it was killed or the power failed.
#pragma once

#include <cstdint>
#include <string>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Suffix of a recording that is being written; it is removed when the file is closed.
inline constexpr const char* kPartSuffix = ".part";

struct RecordingRepair {
  enum class Result {
    kRepaired,  // now whole, ends with the mark of a gap, and has lost the suffix
    kEmpty,     // contained no record: deleted
    kInUse,     // a process still writes it
  };
  Result result = Result::kRepaired;
  std::uint64_t records = 0;    // number of records
  std::uint64_t cut_bytes = 0;  // bytes cut after its last whole record
};

// REQUIRES: `path` ends in kPartSuffix. The file is truncated after its last whole record, synced
// to the disk and renamed. `now`: the end of the marked gap. kUnavailable if the disk reports an
// error; the file is then unchanged, or truncated.
Expected<RecordingRepair> repair_recording(const std::string& path, Timestamp now);

// Syncs the folder that contains `path` to the disk: a rename is durable only then.
void sync_folder_of(const std::string& path);

}  // namespace rayloc
