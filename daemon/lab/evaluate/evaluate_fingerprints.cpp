#include "daemon/lab/evaluate/evaluate_fingerprints.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "daemon/lab/evaluate/fingerprint_map.h"
#include "daemon/lab/evaluate/point_result.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/recorded_frames.h"
#include "daemon/site/survey/points_csv.h"

namespace rayloc {
namespace {

struct Window {
  Timestamp begin;
  Timestamp end;
};

using Frames = std::vector<CsiFrame>;

// The frames of the recordings within each window, which may overlap.
class WindowFrames {
 public:
  explicit WindowFrames(const std::vector<Window>& windows) : frames_(windows.size()) {
    for (std::size_t i = 0; i < windows.size(); ++i) {
      by_begin_.emplace_back(windows[i], i);
      longest_ = std::max(longest_, windows[i].end - windows[i].begin);
    }
    std::sort(by_begin_.begin(), by_begin_.end(), [](const auto& a, const auto& b) {
      return a.first.begin < b.first.begin;
    });
  }

  void add(const CsiFrame& frame) {
    auto window = std::lower_bound(
        by_begin_.begin(), by_begin_.end(), frame.time - longest_, [](const auto& w, Timestamp t) {
          return w.first.begin < t;
        });
    for (; window != by_begin_.end() && window->first.begin <= frame.time; ++window) {
      if (frame.time <= window->first.end) {
        frames_[window->second].push_back(frame);
        any_ = true;
      }
    }
  }
  bool any() const { return any_; }
  std::vector<Frames>& frames() { return frames_; }

 private:
  std::vector<std::pair<Window, std::size_t>> by_begin_;
  Duration longest_{};
  std::vector<Frames> frames_;
  bool any_ = false;
};

Expected<std::vector<Frames>> read_windows(const Site& site,
                                           const FingerprintRequest& request,
                                           const std::vector<CaptureArgument>& captures,
                                           const std::vector<Window>& windows,
                                           const Observer& observer) {
  WindowFrames found(windows);
  std::vector<std::string> notes;
  for (const RecordingArgument& recording : recordings_of(captures)) {
    const auto use = [&](CsiFrame&& frame) {
      const bool wanted =
          request.transmitter.empty()
              ? (find_fixed_transmitter(site, frame.transmitter) != nullptr) == request.person
              : to_string(frame.transmitter) == request.transmitter;
      if (wanted) {
        found.add(frame);
      }
    };
    RAYLOC_TRY(for_each_frame(site, recording, use, notes));
  }
  for (const std::string& note : notes) {
    observer.note(note);
  }
  if (!found.any()) {
    return bad_input(captures.front().file + ": no frame of a " +
                     (request.person ? "fixed transmitter" : "device") +
                     " in the times of the points; fingerprints need the recording of that time");
  }
  for (Frames& frames : found.frames()) {
    keep_most_received(frames);
  }
  return std::move(found.frames());
}

// Access points that recorded both the survey and the target: others cannot be compared.
std::vector<FingerprintMap::AccessPoint> common_access_points(
    const Site& site,
    const std::vector<CaptureArgument>& survey,
    const std::vector<CaptureArgument>& captures) {
  std::vector<FingerprintMap::AccessPoint> common;
  for (std::size_t i = 0; i < site.access_points.size(); ++i) {
    const auto recorded = [&](const std::vector<CaptureArgument>& files) {
      return std::any_of(files.begin(), files.end(), [&](const CaptureArgument& file) {
        return file.access_point == site.access_points[i].id;
      });
    };
    if (recorded(survey) && recorded(captures)) {
      common.push_back({i, site.access_points[i].rx_chains});
    }
  }
  return common;
}

Window window_of(const TruthPoint& point) {
  constexpr Duration kAroundInstant = std::chrono::milliseconds(100);
  return point.instant ? Window{point.begin - kAroundInstant, point.end + kAroundInstant}
                       : Window{point.begin, point.end};
}

Expected<FingerprintMap> learn(const Site& site,
                               const FingerprintRequest& request,
                               const std::vector<CaptureArgument>& survey,
                               std::vector<FingerprintMap::AccessPoint> access_points,
                               const Observer& observer) {
  const auto points = load_points_csv(request.points);
  RAYLOC_TRY(points);
  std::vector<Window> windows;
  for (const SurveyPoint& point : *points) {
    windows.push_back({point.t_start, point.t_end});
  }
  const auto frames = read_windows(site, request, survey, windows, observer);
  RAYLOC_TRY(frames);
  FingerprintMap map(site.carrier.grid, std::move(access_points));
  for (std::size_t i = 0; i < points->size(); ++i) {
    map.add((*points)[i].position, (*frames)[i]);
  }
  if (map.size() == 0) {
    return bad_input(survey.front().file + ": no frame has the tones and cores of the site");
  }
  return map;
}

}  // namespace

Expected<std::vector<double>> fingerprint_errors(const Site& site,
                                                 const FingerprintRequest& request,
                                                 const std::vector<TruthPoint>& truth,
                                                 const Observer& observer) {
  const auto ids = access_point_ids(site);
  const auto survey = resolve_captures(request.survey, ids, PerAccessPoint::kSeveral);
  const auto captures = resolve_captures(request.captures, ids, PerAccessPoint::kSeveral);
  if (!survey || !captures) {
    return tl::make_unexpected(survey ? captures.error() : survey.error());
  }
  auto common = common_access_points(site, *survey, *captures);
  if (common.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--fingerprints and --capture share no access point: give the recordings of "
                      "the survey and of the target by the same one");
  }
  const auto map = learn(site, request, *survey, std::move(common), observer);
  RAYLOC_TRY(map);
  std::vector<Window> windows;
  std::transform(truth.begin(), truth.end(), std::back_inserter(windows), window_of);
  const auto frames = read_windows(site, request, *captures, windows, observer);
  RAYLOC_TRY(frames);
  std::vector<double> errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto answer = map->nearest((*frames)[i]);
    errors.push_back(answer ? horizontal_distance(*answer, truth[i].position)
                            : PointResult::kMissed);
  }
  return errors;
}

}  // namespace rayloc
