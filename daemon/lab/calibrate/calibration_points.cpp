#include "daemon/lab/calibrate/calibration_points.h"

#include <complex>
#include <cstddef>
#include <utility>

#include "engine/observe/burst.h"

namespace rayloc {

CombinedSurvey combine_survey(const RoomModel& room,
                              const std::vector<bool>& held,
                              const std::string& points_file,
                              CalibrationInputs& inputs) {
  CombinedSurvey survey;
  survey.first_refusal.resize(room.access_points.size());
  for (std::size_t p = 0; p < inputs.points.size(); ++p) {
    const SurveyedFrames& surveyed = inputs.points[p];
    CalibrationPoint point{surveyed.point.position, held[p], {}};
    for (std::size_t a = 0; a < room.access_points.size(); ++a) {
      auto burst =
          combine_burst(surveyed.frames, {a, room.grid, room.access_points[a].rx_chains, {}});
      if (!burst && burst.error().message != "no frames") {
        const std::string what = points_file + ":" + std::to_string(surveyed.point.line) + " " +
                                 room.access_points[a].id;
        inputs.refused.push_back({what, burst.error().message});
        if (survey.first_refusal[a].empty()) {
          survey.first_refusal[a] = what + ": " + burst.error().message;
        }
      }
      point.h.push_back(burst ? std::move(burst->h) : std::vector<std::complex<double>>());
    }
    survey.points.push_back(std::move(point));
  }
  return survey;
}

}  // namespace rayloc
