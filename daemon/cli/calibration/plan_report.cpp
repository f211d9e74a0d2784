#include "daemon/cli/calibration/plan_report.h"

#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "daemon/base/output_file.h"
#include "daemon/lab/draw/picture_bytes.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc::cli {
namespace {

std::string picture_file(const PlanOutput& output) {
  if (!output.picture.empty() || output.csv == "-") {
    return output.picture;
  }
  return std::filesystem::path(output.csv).replace_extension(".svg").string();
}

Expected<void> write_picture(const draw::Drawing& drawing, const std::string& file) {
  const auto bytes = draw::picture_bytes(drawing, file);
  return bytes ? write_file(file, *bytes) : tl::make_unexpected(bytes.error());
}

void print_coverage(const PlanCoverage& coverage, std::size_t points) {
  std::fprintf(stderr,
               "%zu points of %zu places; %zu of %zu pairs of surface and access point are seen in "
               "reflections from %zu points or more\n",
               points,
               coverage.candidates,
               coverage.enough,
               coverage.pairs,
               coverage.wanted);
  for (const WeakObject& weak : coverage.weak) {
    std::fprintf(stderr,
                 "  %s: a side of it to %s from %zu of the %zu places where it is seen\n",
                 weak.object.c_str(),
                 weak.access_point.c_str(),
                 weak.points,
                 weak.candidates);
  }
}

// Measured median errors at 50 points, by the number of survey points to 3 cm
// (engine/studies/2026-11-accuracy.md): a meeting room of 3.5 x 2.9 m and a corridor of 31 x 2.7 m.
struct MeasuredSurvey {
  std::size_t points;
  const char* worth;
};
constexpr std::array<MeasuredSurvey, 3> kMeasured = {
    {{12, "2 cm and 9 cm with three access points, 0.5 m and 1.8 m with one"},
     {36, "2 cm and 4 cm with three access points, 0.4 m and 0.4 m with one"},
     {143, "18 cm with one access point in the meeting room"}}};

// Prints the largest measured survey not larger than the plan, and the gain of more points.
void print_worth(std::size_t points) {
  const MeasuredSurvey* found = nullptr;
  for (const MeasuredSurvey& one : kMeasured) {
    found = one.points <= points ? &one : found;
  }
  if (found == nullptr) {
    return;
  }
  std::fprintf(stderr,
               "expected accuracy, as measured in a meeting room of 3.5 x 2.9 m and a corridor of "
               "31 x 2.7 m: %zu points surveyed to 3 cm located devices to %s\n",
               found->points,
               found->worth);
  if (const MeasuredSurvey* const more = found + 1; more != kMeasured.data() + kMeasured.size()) {
    std::fprintf(
        stderr, "  %zu points (--plan-points %zu): %s\n", more->points, more->points, more->worth);
  }
}

}  // namespace

Expected<void> write_plan(const PlannedSurvey& planned, const PlanOutput& output) {
  if (const std::string file = picture_file(output); !file.empty()) {
    RAYLOC_TRY(write_picture(draw_plan(planned), file));
  }
  auto out = OutputFile::open(output.csv);
  RAYLOC_TRY(out);
  out->write(to_csv(planned.points));
  if (!output.quiet) {
    print_coverage(planned.coverage, planned.points.size());
    print_worth(planned.points.size());
  }
  return out->close();
}

}  // namespace rayloc::cli
