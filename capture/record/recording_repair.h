// What a recorder left behind when it was killed or the power failed: made a whole recording again.
#pragma once

#include <cstdint>
#include <string>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// A recording that is being written is called so, and loses the suffix when it is closed.
inline constexpr const char* kPartSuffix = ".part";

struct RecordingRepair {
  enum class Result {
    kRepaired,  // it is whole now, ends with the mark of a gap, and has lost the suffix
    kEmpty,     // there was no record in it: it is gone
    kInUse,     // somebody still writes it
  };
  Result result = Result::kRepaired;
  std::uint64_t records = 0;    // that it holds
  std::uint64_t cut_bytes = 0;  // behind its last whole record
};

// `path` ends in kPartSuffix. The file is cut behind its last whole record, brought to the disk and
// renamed. `now`: until when the gap is marked. kUnavailable when the disk refuses; the file is
// then as it was, or cut.
Expected<RecordingRepair> repair_recording(const std::string& path, Timestamp now);

// Brings the entries of the folder that `path` lies in to the disk: a rename is safe only then.
void sync_folder_of(const std::string& path);

}  // namespace rayloc
