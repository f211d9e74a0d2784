#include "daemon/cli/verbs/survey_dialogue.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/cli/terminal/stop_signal.h"

namespace rayloc::cli {
namespace {

std::string planned_text(const PlannedPoint& point) {
  return fmt::format("{}{:.3f},{:.3f},{:.3f}",
                     point.name.empty() ? "" : point.name + " at ",
                     point.position.x,
                     point.position.y,
                     point.position.z);
}

}  // namespace

SurveyDialogue::SurveyDialogue(SurveySession& session, const CountLimits& limits)
    : session_(session), limits_(limits), input_(STDIN_FILENO) {}

Expected<void> SurveyDialogue::run() {
  while (true) {
    const auto point = ask();
    RAYLOC_TRY(point);
    if (!*point) {
      return session_.finish();
    }
    RAYLOC_TRY(measure(**point));
  }
}

// Returns empty when the survey is over.
Expected<std::optional<PlannedPoint>> SurveyDialogue::ask() {
  const PlannedPoint* next = session_.next_planned();
  std::fprintf(stderr,
               "next point (%sx,y,z%s, q to end): ",
               next != nullptr ? ("Enter for " + planned_text(*next) + ", or ").c_str() : "",
               session_.has_plan() ? " or name of a planned point" : "");
  while (true) {
    while (input_.front() == nullptr) {
      if (StopSignal::requested() || input_.ended()) {
        std::fputs("\n", stderr);
        return std::nullopt;
      }
      RAYLOC_TRY(session_.listen());
      input_.poll();
    }
    const auto answer = session_.parse_answer(*input_.front());
    input_.pop();
    if (answer) {
      return answer->quit ? std::nullopt : std::optional(answer->point);
    }
    std::fprintf(stderr, "%s\nnext point: ", answer.error().message.c_str());
  }
}

// An empty line ends a point early; other lines are answers to the next prompt.
bool SurveyDialogue::is_ended_early() {
  input_.poll();
  const bool empty = input_.front() != nullptr && input_.front()->empty();
  if (empty) {
    input_.pop();
  }
  return empty;
}

Expected<void> SurveyDialogue::measure(const PlannedPoint& point) {
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  CountControl control;
  control.on_counts = [&](const std::vector<std::size_t>& counts) {
    if (terminal) {
      std::fprintf(stderr, "\r%s  ", counts_text(counts).c_str());
    }
  };
  control.is_interrupted = StopSignal::requested;
  control.is_ended_early = [this] { return is_ended_early(); };
  const auto counted = session_.count_frames(limits_, control);
  RAYLOC_TRY(counted);
  if (counted->is_interrupted) {
    std::fprintf(stderr, "\n%s: interrupted, not written\n", planned_text(point).c_str());
    return {};
  }
  std::fprintf(stderr,
               "%s%s: %s\n",
               terminal ? "\r" : "",
               planned_text(point).c_str(),
               counts_text(counted->counts).c_str());
  warn_of_silence(counted->counts);
  if (!counted->has_frames()) {
    std::fputs("no frame was received: the point is not written\n", stderr);
    return {};
  }
  return session_.write(*counted, point.position);
}

std::string SurveyDialogue::counts_text(const std::vector<std::size_t>& counts) const {
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    text += fmt::format(
        "{}{} {}/{}", i == 0 ? "" : "  ", session_.access_point(i), counts[i], limits_.frames);
  }
  return text;
}

void SurveyDialogue::warn_of_silence(const std::vector<std::size_t>& counts) const {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) {
      std::fprintf(stderr,
                   "warning: %s received no whole frame of the device\n",
                   session_.access_point(i).c_str());
    }
  }
}

}  // namespace rayloc::cli
