// SurveyDialogue: asks a person for the points of a survey and shows the counted frames.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/cli/terminal/line_input.h"
#include "daemon/site/survey/survey_session.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Prompts on standard error and reads lines of standard input. Thread safety: one thread.
class SurveyDialogue {
 public:
  // `session` must outlive it. REQUIRES: StopSignal is installed.
  SurveyDialogue(SurveySession& session, const CountLimits& limits);

  // Surveys points until the person ends it, the input ends, or a signal arrives.
  Expected<void> run();

 private:
  Expected<std::optional<PlannedPoint>> ask();
  bool is_ended_early();
  Expected<void> measure(const PlannedPoint& point);
  std::string counts_text(const std::vector<std::size_t>& counts) const;
  void warn_of_silence(const std::vector<std::size_t>& counts) const;

  SurveySession& session_;
  CountLimits limits_;
  LineInput input_;
};

}  // namespace rayloc::cli
