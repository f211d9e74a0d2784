// SurveySession: a survey in progress: the next planned point, the frames counted at a point, and
// its row in the points file.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/site/model/room_model.h"
#include "daemon/site/survey/planned_points.h"
#include "daemon/site/survey/survey_answer.h"
#include "daemon/site/survey/survey_file.h"
#include "daemon/site/survey/survey_listener.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Fails (kUsage) if a device cannot be at that position [m]: outside of the room or inside of an
// object. The message states the bounds or the object.
Expected<void> check_survey_point(const RoomModel& room, const Vec3d& position);

struct CountLimits {
  std::size_t frames = 20;                      // of every access point; then the point ends
  Duration timeout = std::chrono::seconds(30);  // a point ends after it in any case
};

// Control of the counting by a person; called between reads, each must be set.
struct CountControl {
  std::function<void(const std::vector<std::size_t>& counts)> on_counts;  // by port, so far
  std::function<bool()> is_interrupted;                                   // the point is dropped
  std::function<bool()> is_ended_early;                                   // the point is kept
};

struct CountedPoint {
  Timestamp start;
  std::vector<std::size_t> counts;  // frames by port
  bool is_interrupted = false;

  // REQUIRES: at least one port.
  bool has_frames() const;
};

// Thread safety: one thread.
class SurveySession {
 public:
  SurveySession(RoomModel room,
                SurveyListener listener,
                SurveyFile file,
                std::vector<PlannedPoint> plan);

  bool has_plan() const { return !plan_.empty(); }
  // The first planned point without a row within a centimetre; nullptr if there is none.
  const PlannedPoint* next_planned() const;
  // The typed answer (survey_answer.h), with a point that can be surveyed. An Error states the
  // objection.
  Expected<SurveyAnswer> parse_answer(std::string_view line) const;

  // Reads the ports between points.
  Expected<void> listen() { return listener_.listen(kListenTick); }
  // Counts frames from now on until a limit is reached or the control ends it.
  Expected<CountedPoint> count_frames(const CountLimits& limits, const CountControl& control);
  // Appends the row of a counted point, which ends now.
  Expected<void> write(const CountedPoint& counted, const Vec3d& position);
  // Syncs the recordings to the disk; an Error if any data could not be written.
  Expected<void> finish() { return listener_.finish(); }

  const std::string& access_point(std::size_t port) const { return listener_.access_point(port); }
  std::size_t points_written() const { return written_; }

 private:
  static constexpr Duration kListenTick = std::chrono::milliseconds(20);

  RoomModel room_;
  SurveyListener listener_;
  SurveyFile file_;
  std::vector<PlannedPoint> plan_;
  std::size_t written_ = 0;
};

}  // namespace rayloc
