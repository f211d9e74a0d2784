#include "daemon/lab/reference/measured_links.h"

#include <algorithm>
#include <complex>
#include <iterator>
#include <utility>

#include "engine/person/calibrate/occupied_room.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

// Largest difference between the clocks of access points and survey.
constexpr Duration kReferenceClockSlack = std::chrono::milliseconds(20);
// Number of frames of the empty room averaged for each access point.
constexpr std::size_t kMaxEmptyFrames = 1024;
// Largest change of the channel of an empty room within its recording, as a share of its power.
constexpr double kMaxChange = 0.02;

void add_array(const std::vector<std::complex<double>>& array, ContentHash& content) {
  for (const auto& value : array) {
    content.add(value.real());
    content.add(value.imag());
  }
}

std::vector<CsiFrame> frames_at(const SurveyPoint& point, const std::vector<CsiFrame>& frames) {
  std::vector<CsiFrame> own;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(own), [&](const CsiFrame& frame) {
    return frame.time >= point.t_start - kReferenceClockSlack &&
           frame.time <= point.t_end + kReferenceClockSlack;
  });
  return own;
}

}  // namespace

Expected<std::vector<EmptyRoom>> receive_empty_room(const RoomModel& room,
                                                    const std::vector<CsiFrame>& frames,
                                                    bool occupied,
                                                    InputLog& log) {
  BurstOptions burst_options;
  burst_options.max_frames = kMaxEmptyFrames;
  std::vector<EmptyRoom> received;
  for (std::size_t a = 0; a < room.access_points.size(); ++a) {
    const RoomAccessPoint& ap = room.access_points[a];
    const bool recorded = std::any_of(frames.begin(), frames.end(), [&](const CsiFrame& frame) {
      return frame.access_point == a;
    });
    if (!recorded) {
      log.refused.push_back({ap.id, "not in the recordings: it will not look for people"});
      continue;
    }
    if (const std::string problem = calibration_problem(room, ap); !problem.empty()) {
      return make_error(ErrorKind::kConfiguration, "access point " + ap.id + " " + problem);
    }
    std::vector<std::string> warnings;
    auto burst = occupied ? receive_background(room, a, frames, burst_options, warnings)
                          : preprocess_burst(room, a, frames, burst_options, warnings);
    if (!burst) {
      return bad_input(warnings.front());
    }
    if (!occupied && burst->motion_residual > kMaxChange) {
      return bad_input("access point " + ap.id + ": the channel of " +
                       to_string(frames.front().transmitter) +
                       " changes during the recording of the empty room; record it again with no "
                       "person inside and nothing moving, or give --occupied");
    }
    add_array(burst->h, log.content);
    received.push_back({a, std::move(burst->h)});
  }
  return received;
}

MeasuredPoints receive_points(const RoomModel& room,
                              const PersonReference& reference,
                              const ReferenceInputs& inputs,
                              InputLog& log) {
  const std::vector<CsiFrame>& frames = inputs.people.at(reference.mac);
  MeasuredPoints measured;
  for (const SurveyPoint& point : inputs.points) {
    std::vector<CsiFrame> own = frames_at(point, frames);
    PersonPoint person_point{{point.position.x, point.position.y}, {}};
    std::vector<std::string> warnings;
    for (const PersonLink& link : reference.links) {
      auto burst = preprocess_burst(room, link.access_point, own, {}, warnings);
      person_point.h.push_back(burst ? std::move(burst->h) : std::vector<std::complex<double>>());
      add_array(person_point.h.back(), log.content);
    }
    log.content.add(person_point.place.x);
    log.content.add(person_point.place.y);
    const std::string what = inputs.points_file + ":" + std::to_string(point.line);
    for (const std::string& warning : warnings) {
      log.refused.push_back({what, warning});
    }
    if (own.empty()) {
      log.refused.push_back({what, "no frames of " + to_string(reference.mac) + " at that time"});
      continue;
    }
    measured.points.push_back(std::move(person_point));
    measured.frames.push_back(std::move(own));
  }
  return measured;
}

}  // namespace rayloc
