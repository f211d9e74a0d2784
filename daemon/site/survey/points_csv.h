// Surveyed points: the positions of a stationary target, each with its begin and end.
//
// `t_start,t_end,x,y,z`: seconds since 1970 by the clock of the recording, metres in the frame of
// the site. Further columns are ignored.
#pragma once

#include <filesystem>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"

namespace rayloc {

class CsvTable;

struct SurveyPoint {
  Timestamp t_start;
  Timestamp t_end;  // not before t_start
  Vec3d position;   // [m]
  int line = 0;     // line in the file, for messages
};

// In the order of the file; at least one.
Expected<std::vector<SurveyPoint>> load_points_csv(const std::filesystem::path& path);
Expected<std::vector<SurveyPoint>> read_points(const CsvTable& table);

// `t,x,y,z`: positions of a target at instants, each being both begin and end.
bool has_instants(const CsvTable& table);
Expected<std::vector<SurveyPoint>> read_instants(const CsvTable& table);

}  // namespace rayloc
