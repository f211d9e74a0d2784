// SurveyFile: the points csv that `rayloc survey` writes: a row is on the disk before the next
// point begins.
#pragma once

#include <string>
#include <vector>

#include "daemon/base/output_file.h"
#include "daemon/site/survey/points_csv.h"
#include "engine/base/expected.h"

namespace rayloc {

class SurveyFile {
 public:
  // An existing file is continued: its points are those of an earlier part of the survey. An Error
  // if it is no points file or ends inside a line.
  static Expected<SurveyFile> open(const std::string& path);

  // Points of this part of the survey and of earlier parts.
  const std::vector<SurveyPoint>& points() const { return points_; }
  Expected<void> append(const SurveyPoint& point);

 private:
  SurveyFile(std::string path, std::vector<SurveyPoint> points)
      : path_(std::move(path)), points_(std::move(points)) {}

  std::string path_;
  std::vector<SurveyPoint> points_;
};

}  // namespace rayloc
