#include "daemon/lab/train/train_survey.h"

#include <algorithm>
#include <map>
#include <utility>

#include "daemon/lab/calibrate/calibration_inputs.h"
#include "daemon/lab/calibrate/survey_clock.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/fixed_frames.h"
#include "daemon/site/survey/time_offset.h"
#include "engine/base/content_hash.h"

namespace rayloc {
namespace {

// Largest difference between the clocks of access points and survey.
constexpr Duration kTrainingClockSlack = std::chrono::milliseconds(20);

using Frames = std::map<MacAddress, std::vector<CsiFrame>>;

Expected<Frames> read_frames(const Site& site,
                             const std::vector<std::string>& arguments,
                             std::vector<std::string>& notes) {
  const auto captures =
      resolve_captures(arguments, access_point_ids(site), PerAccessPoint::kSeveral);
  RAYLOC_TRY(captures);
  auto frames = read_fixed_frames(site, *captures, notes);
  if (frames) {
    for (auto& [mac, all] : *frames) {
      std::stable_sort(all.begin(), all.end(), [](const CsiFrame& a, const CsiFrame& b) {
        return a.time < b.time;
      });
    }
  }
  return frames;
}

std::vector<TrainingPoint> cut(const std::vector<CsiFrame>& frames,
                               const std::vector<SurveyPoint>& points) {
  std::vector<TrainingPoint> all;
  for (const SurveyPoint& point : points) {
    TrainingPoint one{point.position, {}};
    std::copy_if(
        frames.begin(), frames.end(), std::back_inserter(one.frames), [&](const CsiFrame& frame) {
          return frame.time >= point.t_start - kTrainingClockSlack &&
                 frame.time <= point.t_end + kTrainingClockSlack;
        });
    if (!one.frames.empty()) {
      all.push_back(std::move(one));
    }
  }
  return all;
}

void add_frames(const std::vector<CsiFrame>& frames, ContentHash& hash) {
  for (const CsiFrame& frame : frames) {
    hash.add(static_cast<std::uint64_t>(frame.access_point));
    hash.add(static_cast<std::uint64_t>(frame.time.time_since_epoch().count()));
    for (const auto value : frame.csi.values()) {
      hash.add(static_cast<double>(value.real()));
      hash.add(static_cast<double>(value.imag()));
    }
  }
}

std::string hash_of(const TrainSurvey& survey) {
  ContentHash hash;
  for (const TrainingPoint& point : survey.points) {
    hash.add(point.position);
    add_frames(point.frames, hash);
  }
  add_frames(survey.empty, hash);
  return hash.text();
}

}  // namespace

Expected<TrainSurvey> read_device_survey(const Site& site,
                                         const RoomModel& room,
                                         const SurveyArguments& arguments) {
  const auto captures =
      resolve_captures(arguments.captures, access_point_ids(site), PerAccessPoint::kSeveral);
  RAYLOC_TRY(captures);
  auto read = read_calibration_inputs(
      with_bounds(site, room), *captures, arguments.points, arguments.time_offset);
  RAYLOC_TRY(read);
  TrainSurvey survey;
  for (SurveyedFrames& surveyed : read->points) {
    if (!surveyed.frames.empty()) {
      survey.points.push_back({surveyed.point.position, std::move(surveyed.frames)});
    }
  }
  survey.notes = std::move(read->notes);
  survey.content = std::move(read->content);
  return survey;
}

Expected<TrainSurvey> read_people_survey(const Site& site, const SurveyArguments& arguments) {
  const auto points =
      load_points_csv(arguments.points, arguments.time_offset.value_or(Duration(0)));
  RAYLOC_TRY(points);
  TrainSurvey survey;
  const auto frames = read_frames(site, arguments.captures, survey.notes);
  RAYLOC_TRY(frames);
  for (const auto& [mac, all] : *frames) {
    auto received = cut(all, *points);
    if (received.size() > survey.points.size()) {
      survey.points = std::move(received);
      survey.transmitter = mac;
    }
  }
  if (!survey.transmitter && !frames->empty() && !frames->begin()->second.empty()) {
    const auto& [mac, all] = *frames->begin();
    return bad_input("--capture: received " + to_string(mac) + " " +
                     explain_other_times(arguments.points, *points, DeviceTrace::of(all)));
  }
  if (!survey.transmitter) {
    return bad_input(arguments.points +
                     ": no fixed transmitter of the site is received at the time of any point; "
                     "give the recording of one of the [[transmitter]] with role = \"fixed\"");
  }
  if (!arguments.empty.empty()) {
    auto empty = read_frames(site, arguments.empty, survey.notes);
    RAYLOC_TRY(empty);
    survey.empty = std::move((*empty)[*survey.transmitter]);
    if (survey.empty.empty()) {
      return bad_input("--empty: does not hold " + to_string(*survey.transmitter) +
                       ", the sender of the survey");
    }
  }
  survey.content = hash_of(survey);
  return survey;
}

}  // namespace rayloc
