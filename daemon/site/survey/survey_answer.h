// The input of a person at the prompt of `rayloc survey`.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "daemon/site/survey/planned_points.h"
#include "engine/base/expected.h"

namespace rayloc {

struct SurveyAnswer {
  bool quit = false;
  PlannedPoint point;  // without a name if coordinates were typed
};

// "q" ends; "x,y,z" or, at the usual height, "x,y" is a place [m]; a name is that planned point;
// empty input is `next`. An Error states the valid input.
Expected<SurveyAnswer> parse_survey_answer(std::string_view line,
                                           std::span<const PlannedPoint> plan,
                                           const PlannedPoint* next,
                                           double usual_height);

}  // namespace rayloc
