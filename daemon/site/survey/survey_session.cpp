#include "daemon/site/survey/survey_session.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/scene/solid_around.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr double kSamePlace = 0.01;  // [m]: a planned point this close to a row is done

}  // namespace

Expected<void> check_survey_point(const RoomModel& room, const Vec3d& position) {
  const Vec3d& p = position;
  const Vec3d& lower = room.bounds_min;
  const Vec3d& upper = room.bounds_max;
  if (p.x < lower.x || p.y < lower.y || p.z < lower.z || p.x > upper.x || p.y > upper.y ||
      p.z > upper.z) {
    return make_error(
        ErrorKind::kUsage,
        fmt::format(
            "outside of the room: x {:.2f} to {:.2f}, y {:.2f} to {:.2f}, z {:.2f} to {:.2f}",
            lower.x,
            upper.x,
            lower.y,
            upper.y,
            lower.z,
            upper.z));
  }
  if (const auto solid = solid_around(*room.scene, p)) {
    return make_error(ErrorKind::kUsage,
                      "inside of object '" + printable(room.scene->objects()[*solid].name) + "'");
  }
  return {};
}

bool CountedPoint::has_frames() const {
  return *std::max_element(counts.begin(), counts.end()) != 0;
}

SurveySession::SurveySession(RoomModel room,
                             SurveyListener listener,
                             SurveyFile file,
                             std::vector<PlannedPoint> plan)
    : room_(std::move(room)),
      listener_(std::move(listener)),
      file_(std::move(file)),
      plan_(std::move(plan)) {}

const PlannedPoint* SurveySession::next_planned() const {
  for (const PlannedPoint& planned : plan_) {
    const bool done =
        std::any_of(file_.points().begin(), file_.points().end(), [&](const SurveyPoint& point) {
          return norm(point.position - planned.position) < kSamePlace;
        });
    if (!done) {
      return &planned;
    }
  }
  return nullptr;
}

Expected<SurveyAnswer> SurveySession::parse_answer(std::string_view line) const {
  auto answer = parse_survey_answer(line, plan_, next_planned(), room_.device.height);
  if (!answer || answer->quit) {
    return answer;
  }
  RAYLOC_TRY(check_survey_point(room_, answer->point.position));
  return answer;
}

Expected<CountedPoint> SurveySession::count_frames(const CountLimits& limits,
                                                   const CountControl& control) {
  CountedPoint counted;
  counted.start = std::chrono::system_clock::now();
  const auto deadline = std::chrono::steady_clock::now() + limits.timeout;
  listener_.start_counting(counted.start);
  do {
    RAYLOC_TRY(listener_.listen(kListenTick));
    counted.counts = listener_.counts();
    control.on_counts(counted.counts);
    if (control.is_interrupted()) {
      counted.is_interrupted = true;
      return counted;
    }
  } while (*std::min_element(counted.counts.begin(), counted.counts.end()) < limits.frames &&
           !control.is_ended_early() && std::chrono::steady_clock::now() < deadline);
  return counted;
}

Expected<void> SurveySession::write(const CountedPoint& counted, const Vec3d& position) {
  ++written_;
  return file_.append({counted.start, std::chrono::system_clock::now(), position, 0});
}

}  // namespace rayloc
