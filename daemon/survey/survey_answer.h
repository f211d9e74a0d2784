// What a person types at the prompt of `rayloc survey`.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "daemon/survey/planned_points.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct SurveyAnswer {
  bool quit = false;
  PlannedPoint point;  // its name empty where a place was typed
};

// "q" ends; "x,y,z" or, at the usual height, "x,y" is a place [m]; a name is that planned point;
// nothing is `next`. An Error says what to type instead.
Expected<SurveyAnswer> parse_survey_answer(std::string_view line,
                                           std::span<const PlannedPoint> plan,
                                           const PlannedPoint* next,
                                           double usual_height);

}  // namespace rayloc::cli
