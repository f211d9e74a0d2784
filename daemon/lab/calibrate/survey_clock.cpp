#include "daemon/lab/calibrate/survey_clock.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include <spdlog/fmt/fmt.h>

namespace rayloc {
namespace {

constexpr Duration kPairSpacing = std::chrono::milliseconds(150);  // a walking person covers 0.2 m
constexpr Duration kLongestPair = std::chrono::seconds(2);
constexpr Duration kFinestStep = std::chrono::milliseconds(50);
constexpr Duration kCoarsestStep = std::chrono::seconds(1);
constexpr double kMaxComparisons = 2e8;               // pairs of a point and an offset
constexpr std::size_t kFewestMatches = 3;             // two points fit nearly every recording
constexpr double kMinShareOfPoints = 0.6;             // a share
constexpr double kRivalShare = 0.75;                  // share of the best offset's points
constexpr double kMoves = 0.15;                       // spread of the correlations of a walk
constexpr Duration kZone = std::chrono::minutes(15);  // time zones are multiples of this
constexpr Duration kFarthestZone = std::chrono::hours(14);

bool same_shape(const CsiFrame& a, const CsiFrame& b) {
  return a.rx_chains == b.rx_chains && a.tone_index == b.tone_index &&
         a.csi.values().size() == b.csi.values().size();
}

// Normalised correlation of two frames, invariant to common phase and timing.
double correlation_of(const CsiFrame& a, const CsiFrame& b) {
  const std::size_t tones = a.tone_index.size();
  const auto& va = a.csi.values();
  const auto& vb = b.csi.values();
  if (tones == 0 || va.empty()) {
    return 0.0;
  }
  std::vector<std::complex<double>> product(tones);
  double power_a = 0.0;
  double power_b = 0.0;
  for (std::size_t i = 0; i < va.size(); ++i) {
    const std::complex<double> x(va[i]);
    const std::complex<double> y(vb[i]);
    product[i % tones] += x * std::conj(y);
    power_a += std::norm(x);
    power_b += std::norm(y);
  }
  std::complex<double> slope;
  for (std::size_t t = 1; t < tones; ++t) {
    slope += product[t] * std::conj(product[t - 1]);
  }
  const double step = std::arg(slope);
  std::complex<double> sum;
  for (std::size_t t = 0; t < tones; ++t) {
    sum += product[t] * std::polar(1.0, -step * static_cast<double>(t));
  }
  const double power = std::sqrt(power_a * power_b);
  return power > 0.0 ? std::abs(sum) / power : 0.0;
}

// Sums over cells of time for one offset, so that every
// window of the survey is computed from two differences.
class Cells {
 public:
  Cells(const DeviceTrace& trace, Timestamp begin, Duration step, std::size_t count)
      : begin_(begin), step_(step), frames_(count + 1), pairs_(count + 1), sums_(count + 1) {
    for (const Timestamp time : trace.times()) {
      ++frames_[cell(time - begin_) + 1];
    }
    for (const DeviceTrace::Pair& pair : trace.pairs()) {
      const std::size_t middle = cell((pair.first - begin_) / 2 + (pair.second - begin_) / 2) + 1;
      ++pairs_[middle];
      sums_[middle] += pair.correlation;
    }
    std::size_t filled = 0;
    const std::size_t second =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::chrono::seconds(1) / step_));
    for (std::size_t c = 1; c <= count; ++c) {
      frames_[c] += frames_[c - 1];
      pairs_[c] += pairs_[c - 1];
      sums_[c] += sums_[c - 1];
      filled += frames_[c] > frames_[c < second ? 0 : c - second] ? 1U : 0U;
    }
    is_continuous_ = 2 * filled > count;
    find_threshold(trace);
    find_usual_gap(trace);
  }

  // Frames from `from` to `to` of a device that is stationary throughout; 0 if it is not.
  std::size_t frames(Duration from, Duration to) const {
    const std::size_t i = edge(floor_of(from));
    const std::size_t j = edge(floor_of(to) + 1);
    if (pairs_[j] > pairs_[i] &&
        sums_[j] - sums_[i] < threshold_ * static_cast<double>(pairs_[j] - pairs_[i])) {
      return 0;
    }
    if (to - from >= 6 * usual_gap_) {
      const Duration third = (to - from) / 3;
      if (frames_[edge(floor_of(from + third) + 1)] == frames_[i] ||
          frames_[j] == frames_[edge(floor_of(to - third))]) {
        return 0;
      }
    }
    return frames_[j] - frames_[i];
  }
  bool is_continuous() const { return is_continuous_; }

 private:
  std::size_t edge(std::int64_t cell) const {
    return static_cast<std::size_t>(
        std::clamp<std::int64_t>(cell, 0, static_cast<std::int64_t>(frames_.size()) - 1));
  }
  std::int64_t floor_of(Duration since) const {
    return since >= Duration(0) ? since / step_ : -1 - (-since - Duration(1)) / step_;
  }
  std::size_t cell(Duration since) const {
    return std::min(static_cast<std::size_t>(std::max<std::int64_t>(0, since / step_)),
                    frames_.size() - 2);
  }
  void find_usual_gap(const DeviceTrace& trace) {
    std::vector<Timestamp> times = trace.times();
    std::sort(times.begin(), times.end());
    std::vector<Duration> gaps;
    for (std::size_t i = 1; i < times.size(); ++i) {
      gaps.push_back(times[i] - times[i - 1]);
    }
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::nth_element(gaps.begin(), middle, gaps.end());
    usual_gap_ = *middle;
  }
  // Only a device that also transmits while it is carried can be classified as stationary.
  void find_threshold(const DeviceTrace& trace) {
    if (!is_continuous_ || trace.pairs().size() < 20) {
      return;
    }
    std::vector<double> all;
    for (const DeviceTrace::Pair& pair : trace.pairs()) {
      all.push_back(pair.correlation);
    }
    std::sort(all.begin(), all.end());
    const double low = all[all.size() / 20];
    const double high = all[all.size() - 1 - all.size() / 20];
    threshold_ = high - low > kMoves ? 0.5 * (low + high) : 0.0;
  }

  Timestamp begin_;
  Duration step_;
  std::vector<std::size_t> frames_;
  std::vector<std::size_t> pairs_;
  std::vector<double> sums_;
  Duration usual_gap_{};
  double threshold_ = 0.0;
  bool is_continuous_ = false;
};

struct Score {
  std::size_t points = 0;
  std::size_t frames = 0;
};

bool operator<(const Score& a, const Score& b) {
  return a.points != b.points ? a.points < b.points : a.frames < b.frames;
}

// The points and the frames of one device on a common time axis.
class OffsetSearch {
 public:
  OffsetSearch(std::span<const SurveyPoint> points, const DeviceTrace& trace)
      : points_(points), trace_(trace) {}

  std::optional<TimeOffset> run() {
    if (points_.size() < kFewestMatches || trace_.times().size() < kFewestMatches ||
        !choose_step()) {
      return std::nullopt;
    }
    const Cells cells(trace_, begin_, step_, static_cast<std::size_t>((end_ - begin_) / step_) + 1);
    scores_.reserve(steps_);
    for (std::size_t i = 0; i < steps_; ++i) {
      scores_.push_back(score(cells, offset(i)));
    }
    const Score stated = score(cells, Duration(0));
    best_ = static_cast<std::size_t>(std::max_element(scores_.begin(), scores_.end()) -
                                     scores_.begin());
    const Plateau plateau = plateau_of(best_);
    const TimeOffset found{round(plateau), scores_[best_].points, stated.points};
    if (is_better(found) && is_clear(found, plateau, cells.is_continuous())) {
      return found;
    }
    return stated.points == 0 ? the_zone(cells) : std::nullopt;
  }

 private:
  struct Plateau {
    std::size_t first = 0;
    std::size_t last = 0;
  };

  bool choose_step() {
    const auto [first, last] = std::minmax_element(trace_.times().begin(), trace_.times().end());
    begin_ = *first;
    end_ = *last;
    survey_begin_ = points_.front().t_start;
    survey_end_ = points_.front().t_end;
    for (const SurveyPoint& point : points_) {
      survey_begin_ = std::min(survey_begin_, point.t_start);
      survey_end_ = std::max(survey_end_, point.t_end);
      longest_ = std::max(longest_, point.t_end - point.t_start);
    }
    const double span = to_seconds(end_ - begin_) + to_seconds(survey_end_ - survey_begin_);
    const double step = std::max(to_seconds(kFinestStep),
                                 span * static_cast<double>(points_.size()) / kMaxComparisons);
    if (step > to_seconds(kCoarsestStep)) {
      return false;  // far from all other times
    }
    step_ = from_seconds(step);
    lowest_ = begin_ - survey_end_;
    steps_ = static_cast<std::size_t>(span / step) + 2;
    return true;
  }

  Duration offset(std::size_t i) const { return lowest_ + static_cast<std::int64_t>(i) * step_; }

  Score score(const Cells& cells, Duration offset) const {
    Score all;
    for (const SurveyPoint& point : points_) {
      const std::size_t frames =
          cells.frames(point.t_start + offset - begin_, point.t_end + offset - begin_);
      all.points += frames > 0 ? 1U : 0U;
      all.frames += frames;
    }
    return all;
  }

  // Neighbouring offsets that fit equally well.
  Plateau plateau_of(std::size_t best) const {
    const auto as_good = [&](std::size_t i) {
      return scores_[i].points == scores_[best].points &&
             50 * scores_[i].frames >= 49 * scores_[best].frames;
    };
    Plateau plateau{best, best};
    while (plateau.first > 0 && as_good(plateau.first - 1)) {
      --plateau.first;
    }
    while (plateau.last + 1 < scores_.size() && as_good(plateau.last + 1)) {
      ++plateau.last;
    }
    return plateau;
  }

  // People set clocks to whole hours, minutes and seconds.
  Duration round(const Plateau& plateau) const {
    const Duration low = offset(plateau.first) - step_;
    const Duration high = offset(plateau.last) + step_;
    const Duration middle = low + (high - low) / 2;
    const std::chrono::milliseconds finest(100);
    for (const Duration unit : {kZone,
                                Duration(std::chrono::minutes(1)),
                                Duration(std::chrono::seconds(1)),
                                Duration(finest)}) {
      const Duration rounded = nearest(middle, unit);
      if (rounded >= low && rounded <= high) {
        return rounded;
      }
    }
    return nearest(middle, finest);
  }

  static Duration nearest(Duration value, Duration unit) {
    return std::llround(to_seconds(value) / to_seconds(unit)) * unit;
  }

  bool is_better(const TimeOffset& found) const {
    const std::size_t margin = std::max<std::size_t>(2, points_.size() / 4);
    const double least = kMinShareOfPoints * static_cast<double>(points_.size());
    return found.points >= found.as_stated + margin && found.points >= kFewestMatches &&
           static_cast<double>(found.points) >= least;
  }

  // Regularly timed points fit nearly as well some rows off; then all points must match.
  bool is_clear(const TimeOffset& found, const Plateau& plateau, bool is_continuous) const {
    const auto away = static_cast<std::size_t>((longest_ + std::chrono::seconds(1)) / step_) + 1;
    std::size_t rival = 0;
    for (std::size_t i = 0; i < scores_.size(); ++i) {
      if (i + away < plateau.first || i > plateau.last + away) {
        rival = std::max(rival, scores_[i].points);
      }
    }
    return static_cast<double>(rival) <= kRivalShare * static_cast<double>(found.points) ||
           (found.points == points_.size() && rival < found.points &&
            (!is_continuous || 2 * found.as_stated <= points_.size()));
  }

  // A recording of less than a quarter of an hour
  // contains all points for one time zone at most.
  std::optional<TimeOffset> the_zone(const Cells& cells) const {
    std::optional<TimeOffset> only;
    const Duration first = begin_ - survey_begin_ - kZone;
    for (Duration zone = nearest(first, kZone); zone <= end_ - survey_end_ + kZone; zone += kZone) {
      const std::size_t points = score(cells, zone).points;
      if (points == points_.size() && std::chrono::abs(zone) <= kFarthestZone) {
        if (only) {
          return std::nullopt;
        }
        only = TimeOffset{zone, points, 0};
      }
    }
    return only;
  }

  std::span<const SurveyPoint> points_;
  const DeviceTrace& trace_;
  Timestamp begin_{};
  Timestamp end_{};
  Timestamp survey_begin_{};
  Timestamp survey_end_{};
  Duration longest_{};
  Duration step_{};
  Duration lowest_{};
  std::size_t steps_ = 0;
  std::size_t best_ = 0;
  std::vector<Score> scores_;
};

std::string number_text(double seconds) {
  return seconds == std::round(seconds) ? fmt::format("{:.0f}", seconds)
                                        : fmt::format("{:.1f}", seconds);
}

}  // namespace

DeviceTrace DeviceTrace::of(std::span<const CsiFrame> frames) {
  DeviceTrace trace;
  for (const CsiFrame& frame : frames) {
    if (frame.access_point == frames.front().access_point) {
      trace.add(frame);
    }
  }
  return trace;
}

void DeviceTrace::add(const CsiFrame& frame) {
  times_.push_back(frame.time);
  if (compared_ && frame.time - compared_->time < kPairSpacing && frame.time >= compared_->time) {
    return;
  }
  if (compared_ && frame.time > compared_->time && frame.time - compared_->time <= kLongestPair &&
      same_shape(frame, *compared_)) {
    pairs_.push_back({compared_->time, frame.time, correlation_of(frame, *compared_)});
  }
  compared_ = frame;
}

std::optional<TimeOffset> find_time_offset(std::span<const SurveyPoint> points,
                                           const DeviceTrace& trace) {
  return OffsetSearch(points, trace).run();
}

std::string describe(const TimeOffset& found, OtherRecordings others) {
  const double seconds = std::round(to_seconds(found.offset) * 10.0) / 10.0;
  const std::string fits =
      fmt::format("{:.1f} s {} ({})",
                  std::abs(seconds),
                  seconds < 0.0 ? "earlier" : "later",
                  found.offset % kZone == Duration(0) ? "time zone?" : "a clock that was off?");
  if (others == OtherRecordings::kFit) {
    return fmt::format(
        "{}; the other recordings fit as stated, so shift the time stamps of this one: editcap -t "
        "{} IN OUT",
        fits,
        number_text(-seconds));
  }
  return fmt::format("{}: give --time-offset {}", fits, number_text(seconds));
}

std::string seconds_text(Timestamp time) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", to_seconds(time.time_since_epoch()));
  return text.data();
}

std::string explain_other_times(const std::string& points_file,
                                std::span<const SurveyPoint> points,
                                const DeviceTrace& trace,
                                OtherRecordings others) {
  if (trace.times().empty() || points.empty()) {
    return "never: no frame, or no point";
  }
  const auto [first, last] = std::minmax_element(trace.times().begin(), trace.times().end());
  const auto begin =
      std::min_element(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return a.t_start < b.t_start;
      });
  const auto end = std::max_element(
      points.begin(), points.end(), [](const auto& a, const auto& b) { return a.t_end < b.t_end; });
  const auto found = find_time_offset(points, trace);
  return fmt::format("from {} to {}, the points of {} are from {} to {}: no point has frames; {}",
                     seconds_text(*first),
                     seconds_text(*last),
                     points_file,
                     seconds_text(begin->t_start),
                     seconds_text(end->t_end),
                     found ? "the points fit " + describe(*found, others)
                           : "give the recording of the survey, or, where its clock was another, "
                             "--time-offset SECONDS");
}

}  // namespace rayloc
