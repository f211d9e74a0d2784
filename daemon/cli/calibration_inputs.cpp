#include "daemon/cli/calibration_inputs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "daemon/cli/recorded_frames.h"
#include "engine/base/content_hash.h"
#include "engine/base/vec3.h"

namespace rayloc::cli {
namespace {

// By how much the clocks of access points and of the survey may differ.
constexpr Duration kClockSlack = std::chrono::milliseconds(20);

// What a recording holds.
struct Extent {
  std::size_t fixed_frames = 0;  // of fixed transmitters
  std::size_t frames = 0;        // of all others: when these came
  Timestamp first{};
  Timestamp last{};
};

std::string seconds_text(Timestamp time) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", to_seconds(time.time_since_epoch()));
  return text.data();
}

// The point at whose spot the frame was sent; its window is the survey's, slack included.
SurveyedFrames* point_at(CalibrationInputs& inputs, Timestamp time) {
  for (SurveyedFrames& spot : inputs.points) {
    if (time >= spot.point.t_start - kClockSlack && time <= spot.point.t_end + kClockSlack) {
      return &spot;
    }
  }
  return nullptr;
}

void add_to_hash(ContentHash& hash, const std::string& access_point, const CsiFrame& frame) {
  hash.add(access_point);
  hash.add(to_string(frame.transmitter));
  hash.add(static_cast<std::uint64_t>(frame.time.time_since_epoch().count()));
  for (const auto value : frame.csi.values()) {
    hash.add(static_cast<double>(value.real()));
    hash.add(static_cast<double>(value.imag()));
  }
}

Expected<Extent> read_capture(const Site& site,
                              const CaptureArgument& capture,
                              CalibrationInputs& inputs,
                              ContentHash& hash) {
  Extent extent;
  auto read = for_each_frame(site, capture, [&](CsiFrame&& frame) {
    if (find_fixed_transmitter(site, frame.transmitter) != nullptr) {
      ++extent.fixed_frames;
      return;
    }
    extent.first = extent.frames == 0 ? frame.time : std::min(extent.first, frame.time);
    extent.last = extent.frames == 0 ? frame.time : std::max(extent.last, frame.time);
    ++extent.frames;
    if (SurveyedFrames* spot = point_at(inputs, frame.time)) {
      add_to_hash(hash, capture.access_point, frame);
      spot->frames.push_back(std::move(frame));
    }
  });
  if (!read) {
    return tl::make_unexpected(std::move(read.error()));
  }
  return extent;
}

bool is_inside(const Site& site, const Vec3d& p) {
  return p.x >= site.bounds_min.x && p.x <= site.bounds_max.x && p.y >= site.bounds_min.y &&
         p.y <= site.bounds_max.y && p.z >= site.bounds_min.z && p.z <= site.bounds_max.z;
}

// What a point outside of the room most likely is.
std::string explain_outside(const Site& site,
                            const CalibrationInputs& inputs,
                            const SurveyPoint& point) {
  constexpr double kLargestRoom = 1e6;  // [m]; seconds since 1970 have been more for a long time
  for (const double coordinate : {point.position.x, point.position.y, point.position.z}) {
    if (std::abs(coordinate) > kLargestRoom) {
      return "one of them looks like a time: the columns are t_start,t_end,x,y,z";
    }
  }
  const bool exchanged =
      std::all_of(inputs.points.begin(), inputs.points.end(), [&](const SurveyedFrames& spot) {
        const Vec3d& p = spot.point.position;
        return is_inside(site, {p.y, p.x, p.z});
      });
  if (exchanged) {
    return "with x and y exchanged all points lie inside: are the columns exchanged?";
  }
  return "points are in metres in the frame of the site ([bounds] of site.toml)";
}

Expected<void> check_points(const Site& site,
                            const std::string& file,
                            const CalibrationInputs& inputs) {
  for (const SurveyedFrames& spot : inputs.points) {
    const Vec3d& p = spot.point.position;
    if (site.has_bounds && !is_inside(site, p)) {
      return bad_input(file + ":" + std::to_string(spot.point.line) + ": (" + std::to_string(p.x) +
                       ", " + std::to_string(p.y) + ", " + std::to_string(p.z) +
                       ") lies outside of the room; " + explain_outside(site, inputs, spot.point));
    }
  }
  return {};
}

// Where two transmitters are heard at one point, the one heard most stays.
void keep_one_transmitter(const std::string& file,
                          SurveyedFrames& spot,
                          std::vector<RefusedInput>& refused) {
  if (const auto kept = keep_most_heard(spot.frames)) {
    refused.push_back({file + ":" + std::to_string(spot.point.line),
                       "several transmitters; only " + to_string(*kept) + " is used"});
  }
}

// A recording of another time is a mistake; single points without frames are only left out.
Expected<void> check_overlap(const Site& site,
                             const CaptureArgument& capture,
                             const Extent& extent,
                             const std::string& points_file,
                             CalibrationInputs& inputs) {
  const auto index = find_access_point(site, capture.access_point);
  std::vector<RefusedInput> empty;
  for (const SurveyedFrames& spot : inputs.points) {
    if (std::none_of(spot.frames.begin(), spot.frames.end(), [&](const CsiFrame& frame) {
          return frame.access_point == *index;
        })) {
      empty.push_back(
          {points_file + ":" + std::to_string(spot.point.line) + " " + capture.access_point,
           "no frames at that time"});
    }
  }
  if (empty.size() == inputs.points.size()) {
    if (extent.frames == 0) {
      return bad_input(capture.file + ": no CSI frame of a device for access point '" +
                       capture.access_point + "'" +
                       (extent.fixed_frames > 0
                            ? ", only " + std::to_string(extent.fixed_frames) +
                                  " frames of fixed transmitters; give the recording in "
                                  "which the device was carried from point to point"
                            : "; the recording holds no frame that can be decoded"));
    }
    return bad_input(capture.file + ": access point '" + capture.access_point +
                     "' heard the device from " + seconds_text(extent.first) + " to " +
                     seconds_text(extent.last) + ", the points of " + points_file + " are from " +
                     seconds_text(inputs.points.front().point.t_start) + " to " +
                     seconds_text(inputs.points.back().point.t_end) +
                     ": no point has frames; give the recording of the survey");
  }
  inputs.refused.insert(inputs.refused.end(), empty.begin(), empty.end());
  return {};
}

}  // namespace

Expected<CalibrationInputs> read_calibration_inputs(const Site& site,
                                                    const std::vector<CaptureArgument>& captures,
                                                    const std::string& points_file) {
  auto points = load_points_csv(points_file);
  if (!points) {
    return tl::make_unexpected(std::move(points.error()));
  }
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
  if (auto checked = check_points(site, points_file, inputs); !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  ContentHash content;
  content.add(inputs.points_hash);
  for (const CaptureArgument& capture : captures) {
    const auto index = find_access_point(site, capture.access_point);
    if (!index) {
      return tl::make_unexpected(index.error());
    }
    inputs.recorded[static_cast<std::size_t>(*index)] = true;
    const auto extent = read_capture(site, capture, inputs, content);
    if (!extent) {
      return tl::make_unexpected(extent.error());
    }
    if (auto checked = check_overlap(site, capture, *extent, points_file, inputs); !checked) {
      return tl::make_unexpected(std::move(checked.error()));
    }
  }
  for (SurveyedFrames& spot : inputs.points) {
    keep_one_transmitter(points_file, spot, inputs.refused);
  }
  inputs.content = content.text();
  return inputs;
}

}  // namespace rayloc::cli
