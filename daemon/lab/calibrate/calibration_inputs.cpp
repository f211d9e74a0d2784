#include "daemon/lab/calibrate/calibration_inputs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/calibrate/survey_clock.h"
#include "daemon/lab/recordings/recorded_frames.h"
#include "daemon/site/model/length_unit.h"
#include "daemon/site/survey/time_offset.h"
#include "engine/base/content_hash.h"
#include "engine/base/vec3.h"

namespace rayloc {
namespace {

// Largest difference between the clocks of access points and survey.
constexpr Duration kClockSlack = std::chrono::milliseconds(20);

// Frames and files recorded for one access point.
struct Recorded {
  std::string files;  // file names
  std::size_t fixed_frames = 0;
  std::map<MacAddress, DeviceTrace> devices;
};

// The point at which the frame was sent; the window is the survey's plus the slack.
SurveyedFrames* point_at(CalibrationInputs& inputs, Timestamp time) {
  for (SurveyedFrames& surveyed : inputs.points) {
    if (time >= surveyed.point.t_start - kClockSlack &&
        time <= surveyed.point.t_end + kClockSlack) {
      return &surveyed;
    }
  }
  return nullptr;
}

void add_to_hash(ContentHash& hash, const std::string& access_point, const CsiFrame& frame) {
  hash.add(access_point);
  hash.add(to_string(frame.transmitter));
  hash.add(static_cast<std::uint64_t>(frame.time.time_since_epoch().count()));
  for (const std::uint8_t rx_chain : frame.rx_chains) {
    hash.add(static_cast<std::uint64_t>(rx_chain));
  }
  for (const auto value : frame.csi.values()) {
    hash.add(static_cast<double>(value.real()));
    hash.add(static_cast<double>(value.imag()));
  }
}

Expected<void> read_recording(const Site& site,
                              const RecordingArgument& recording,
                              CalibrationInputs& inputs,
                              Recorded& recorded) {
  recorded.files = files_text(recording);
  const auto use = [&](CsiFrame&& frame) {
    if (find_fixed_transmitter(site, frame.transmitter) != nullptr) {
      ++recorded.fixed_frames;
      return;
    }
    recorded.devices[frame.transmitter].add(frame);
    if (SurveyedFrames* surveyed = point_at(inputs, frame.time)) {
      surveyed->frames.push_back(std::move(frame));
    }
  };
  return for_each_frame(site, recording, use, inputs.notes);
}

bool is_listed(const Site& site, const MacAddress& mac) {
  return find_transmitter(site, mac) != nullptr;  // fixed transmitters were removed before
}

bool lists_devices(const Site& site) {
  return std::any_of(
      site.transmitters.begin(), site.transmitters.end(), [](const SiteTransmitter& one) {
        return one.role == TransmitterRole::kDevice;
      });
}

// The device of the survey: among the listed devices (among all if the site lists none) the one
// received at most points, and among equals the one with most frames. At a single point a
// neighbour's phone may have more frames. Empty if there is none.
std::optional<MacAddress> device_of(const Site& site, const CalibrationInputs& inputs) {
  std::map<MacAddress, std::pair<std::size_t, std::size_t>> received;  // points, frames
  for (const SurveyedFrames& surveyed : inputs.points) {
    std::set<MacAddress> here;
    for (const CsiFrame& frame : surveyed.frames) {
      here.insert(frame.transmitter);
      ++received[frame.transmitter].second;
    }
    for (const MacAddress& mac : here) {
      ++received[mac].first;
    }
  }
  if (lists_devices(site)) {
    std::erase_if(received, [&](const auto& one) { return !is_listed(site, one.first); });
  }
  const auto most =
      std::max_element(received.begin(), received.end(), [](const auto& a, const auto& b) {
        return a.second < b.second;
      });
  return most == received.end() ? std::nullopt : std::optional(most->first);
}

// Frames of other devices carry no information on the position of the survey device.
void keep_device(const std::optional<MacAddress>& device, CalibrationInputs& inputs) {
  std::set<MacAddress> others;
  for (SurveyedFrames& surveyed : inputs.points) {
    std::erase_if(surveyed.frames, [&](const CsiFrame& frame) {
      if (frame.transmitter != device) {
        others.insert(frame.transmitter);
      }
      return frame.transmitter != device;
    });
    // The clock may have been set while the device was at a point.
    std::stable_sort(
        surveyed.frames.begin(), surveyed.frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
          return std::pair(a.access_point, a.time) < std::pair(b.access_point, b.time);
        });
  }
  for (const MacAddress& mac : others) {
    inputs.refused.push_back({to_string(mac),
                              "received during the survey and not used: the surveyed device is " +
                                  (device ? to_string(*device) : "none")});
  }
}

bool is_inside(const Site& site, const Vec3d& p) {
  return p.x >= site.bounds_min.x && p.x <= site.bounds_max.x && p.y >= site.bounds_min.y &&
         p.y <= site.bounds_max.y && p.z >= site.bounds_min.z && p.z <= site.bounds_max.z;
}

// Most likely cause of a point outside the room.
std::string explain_outside(const Site& site,
                            const CalibrationInputs& inputs,
                            const SurveyPoint& point) {
  constexpr double kLargestRoom = 1e6;  // [m]; seconds since 1970 have exceeded it for decades
  for (const double coordinate : {point.position.x, point.position.y, point.position.z}) {
    if (std::abs(coordinate) > kLargestRoom) {
      return "one of them looks like a time: the columns are t_start,t_end,x,y,z";
    }
  }
  const auto all_inside = [&](auto corrected) {
    return std::all_of(
        inputs.points.begin(), inputs.points.end(), [&](const SurveyedFrames& surveyed) {
          return is_inside(site, corrected(surveyed.point.position));
        });
  };
  if (all_inside([](const Vec3d& p) { return Vec3d{p.y, p.x, p.z}; })) {
    return "with x and y exchanged all points lie inside: are the columns exchanged?";
  }
  const auto inside = std::count_if(
      inputs.points.begin(), inputs.points.end(), [&](const SurveyedFrames& surveyed) {
        return is_inside(site, surveyed.point.position);
      });
  // A single typing error does not imply another unit.
  const bool most_outside = 2 * inside < static_cast<std::ptrdiff_t>(inputs.points.size());
  for (const LengthUnit& unit : kMistakenUnits) {
    if (most_outside && all_inside([&](const Vec3d& p) { return unit.metres * p; })) {
      return fmt::format("in {} all points lie inside: write metres", unit.name);
    }
  }
  return "points are in metres in the frame of the site (its [bounds], or what its scene fills)";
}

// A device is at one position at a time: if two rows overlap in time, one is wrong.
Expected<void> check_times(const std::string& file, const CalibrationInputs& inputs) {
  for (std::size_t later = 1; later < inputs.points.size(); ++later) {
    const SurveyPoint& point = inputs.points[later].point;
    for (std::size_t i = 0; i < later; ++i) {
      const SurveyPoint& other = inputs.points[i].point;
      if (point.t_start + kClockSlack < other.t_end && other.t_start + kClockSlack < point.t_end) {
        return bad_input(
            fmt::format("{}:{}: from {} to {} is in the time of row {} ({} to {}): the device is "
                        "at one point at a time",
                        file,
                        point.line,
                        seconds_text(point.t_start),
                        seconds_text(point.t_end),
                        other.line,
                        seconds_text(other.t_start),
                        seconds_text(other.t_end)));
      }
    }
  }
  return {};
}

Expected<void> check_points(const Site& site,
                            const std::string& file,
                            const CalibrationInputs& inputs) {
  for (const SurveyedFrames& surveyed : inputs.points) {
    const Vec3d& p = surveyed.point.position;
    if (site.has_bounds && !is_inside(site, p)) {
      return bad_input(file + ":" + std::to_string(surveyed.point.line) + ": (" +
                       std::to_string(p.x) + ", " + std::to_string(p.y) + ", " +
                       std::to_string(p.z) + ") lies outside of the room; " +
                       explain_outside(site, inputs, surveyed.point));
    }
  }
  return {};
}

std::vector<SurveyPoint> survey_points(const CalibrationInputs& inputs) {
  std::vector<SurveyPoint> points;
  for (const SurveyedFrames& surveyed : inputs.points) {
    points.push_back(surveyed.point);
  }
  return points;
}

// Checks that the recordings of other access points have frames at most points.
OtherRecordings other_recordings(std::size_t access_point, const CalibrationInputs& inputs) {
  const auto with_others = std::count_if(
      inputs.points.begin(), inputs.points.end(), [&](const SurveyedFrames& surveyed) {
        return std::any_of(
            surveyed.frames.begin(), surveyed.frames.end(), [&](const CsiFrame& frame) {
              return frame.access_point != access_point;
            });
      });
  return 5 * with_others >= 4 * static_cast<std::ptrdiff_t>(inputs.points.size())
             ? OtherRecordings::kFit
             : OtherRecordings::kUnknown;
}

// Explains why a recording has no frame of the device at any of the points.
std::string explain_silence(const Site& site,
                            std::size_t access_point,
                            const std::optional<MacAddress>& device,
                            const Recorded& recorded,
                            const CalibrationInputs& inputs,
                            const std::string& points_file) {
  const auto& received = recorded.devices;
  if (received.empty()) {
    std::string all_notes;
    for (const std::string& note : inputs.notes) {
      all_notes += "\n" + note;
    }
    return recorded.fixed_frames > 0
               ? "received no device, only " + std::to_string(recorded.fixed_frames) +
                     " frames of fixed transmitters; give the recording in which the device was "
                     "carried from point to point"
               : "received no device; the recording holds no frame that can be decoded" + all_notes;
  }
  auto found = device ? received.find(*device)
                      : std::find_if(received.begin(), received.end(), [&](const auto& one) {
                          return is_listed(site, one.first);
                        });
  if (found == received.end() && (device || lists_devices(site))) {
    return "received no frame of " +
           (device ? "the device of the survey, " + to_string(*device)
                   : std::string("a device that site.toml lists")) +
           ", only of others (" + to_string(received.begin()->first) +
           "); the [[transmitter]] of the device that was carried states its address";
  }
  found = found == received.end() ? received.begin() : found;
  return "received the device " + to_string(found->first) + " " +
         explain_other_times(points_file,
                             survey_points(inputs),
                             found->second,
                             other_recordings(access_point, inputs));
}

// Points whose frames belong to other points because a clock was off.
Expected<void> check_clock(const MacAddress& device,
                           const std::pair<const std::size_t, Recorded>& recorded,
                           const std::string& access_point,
                           const std::string& points_file,
                           const CalibrationInputs& inputs) {
  const auto trace = recorded.second.devices.find(device);
  if (trace == recorded.second.devices.end()) {
    return {};
  }
  const auto found = find_time_offset(survey_points(inputs), trace->second);
  if (!found) {
    return {};
  }
  return bad_input(
      fmt::format("{}: access point '{}': {} of the {} points of {} fit a device at rest at the "
                  "stated times, but {} fit {}; --time-offset 0 keeps the stated times",
                  recorded.second.files,
                  access_point,
                  found->as_stated,
                  inputs.points.size(),
                  points_file,
                  found->points,
                  describe(*found, other_recordings(recorded.first, inputs))));
}

// A recording of another time is an error; single points without frames are only left out.
Expected<void> check_overlap(const Site& site,
                             const std::optional<MacAddress>& device,
                             const std::pair<const std::size_t, Recorded>& recorded,
                             const std::string& points_file,
                             bool offset_is_stated,
                             CalibrationInputs& inputs) {
  const std::size_t access_point = recorded.first;
  const std::string& id = site.access_points[access_point].id;
  std::vector<RefusedInput> empty;
  for (const SurveyedFrames& surveyed : inputs.points) {
    if (std::none_of(surveyed.frames.begin(), surveyed.frames.end(), [&](const CsiFrame& frame) {
          return frame.access_point == access_point;
        })) {
      empty.push_back({fmt::format("{}:{} {}", points_file, surveyed.point.line, id),
                       "no frames at that time"});
    }
  }
  if (empty.size() == inputs.points.size()) {
    return bad_input(
        recorded.second.files + ": access point '" + id + "' " +
        explain_silence(site, access_point, device, recorded.second, inputs, points_file));
  }
  if (device && !offset_is_stated) {
    RAYLOC_TRY(check_clock(*device, recorded, id, points_file, inputs));
  }
  if (2 * empty.size() > inputs.points.size()) {
    inputs.notes.push_back(fmt::format("{}: access point '{}' has frames at {} of {} points only",
                                       recorded.second.files,
                                       id,
                                       inputs.points.size() - empty.size(),
                                       inputs.points.size()));
  }
  inputs.refused.insert(inputs.refused.end(), empty.begin(), empty.end());
  return {};
}

std::string hash_of_frames(const Site& site, const CalibrationInputs& inputs) {
  ContentHash content;
  content.add(inputs.points_hash);
  for (const SurveyedFrames& surveyed : inputs.points) {
    for (const CsiFrame& frame : surveyed.frames) {
      add_to_hash(content, site.access_points[frame.access_point].id, frame);
    }
  }
  return content.text();
}

}  // namespace

Site with_bounds(Site site, const RoomModel& room) {
  site.bounds_min = room.bounds_min;
  site.bounds_max = room.bounds_max;
  site.has_bounds = true;
  return site;
}

Expected<CalibrationInputs> read_calibration_inputs(const Site& site,
                                                    const std::vector<CaptureArgument>& captures,
                                                    const std::string& points_file,
                                                    std::optional<Duration> time_offset) {
  auto points = load_points_csv(points_file, time_offset.value_or(Duration(0)));
  RAYLOC_TRY(points);
  CalibrationInputs inputs;
  inputs.recorded.resize(site.access_points.size());
  ContentHash points_hash;
  for (const SurveyPoint& point : *points) {
    inputs.points.push_back({point, {}});
    points_hash.add(static_cast<std::uint64_t>(point.t_start.time_since_epoch().count()));
    points_hash.add(point.position.x);
    points_hash.add(point.position.y);
    points_hash.add(point.position.z);
  }
  inputs.points_hash = points_hash.text();
  RAYLOC_TRY(check_points(site, points_file, inputs));
  RAYLOC_TRY(check_times(points_file, inputs));
  std::map<std::size_t, Recorded> recorded;  // by access point
  for (const RecordingArgument& recording : recordings_of(captures)) {
    const auto index = find_access_point(site, recording.access_point);
    RAYLOC_TRY(index);
    inputs.recorded[*index] = true;
    RAYLOC_TRY(read_recording(site, recording, inputs, recorded[*index]));
  }
  const std::optional<MacAddress> device = device_of(site, inputs);
  keep_device(device, inputs);
  for (const auto& one : recorded) {
    RAYLOC_TRY(check_overlap(site, device, one, points_file, time_offset.has_value(), inputs));
  }
  inputs.content = hash_of_frames(site, inputs);
  return inputs;
}

}  // namespace rayloc
