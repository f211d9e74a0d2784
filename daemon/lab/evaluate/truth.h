// Truth: the true positions of the target, and the estimates that match them.
#pragma once

#include <filesystem>
#include <vector>

#include "daemon/lab/evaluate/estimates_file.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"

namespace rayloc {

class CsvTable;

struct TruthPoint {
  // A test point: the target was stationary from `begin` to `end`. An instant: both are equal.
  Timestamp begin;
  Timestamp end;
  bool instant = false;
  Vec3d position;  // [m]
};

// `t_start,t_end,x,y,z` per test point or `t,x,y,z` per instant; further columns are ignored. At
// least one row. Errors name file:line:column.
Expected<std::vector<TruthPoint>> load_truth(const std::filesystem::path& file);
Expected<std::vector<TruthPoint>> read_truth(const CsvTable& table);

// The same points by a clock that is `offset` ahead (wall = recording + offset).
std::vector<TruthPoint> shifted(std::vector<TruthPoint> truth, Duration offset);

// The estimate that matches each point; nullptr if there is none. Per test point the
// last estimate with a time in [begin, end + 0.1 s]: a burst may end a little
// after the target was asked to move on. Per instant the nearest within 0.06
// s, of two equally near ones the earlier. The pointers are into `estimates`.
std::vector<const LocationEstimate*> match(const std::vector<TruthPoint>& truth,
                                           const std::vector<PublishedEstimate>& estimates);

}  // namespace rayloc
