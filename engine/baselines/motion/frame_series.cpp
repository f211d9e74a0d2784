#include "engine/baselines/motion/frame_series.h"

#include <algorithm>
#include <utility>

#include "engine/base/median.h"

namespace rayloc {
namespace {

constexpr std::size_t kReliableFrames =
    20;  // frames, a count, chosen: fewer give no reliable median

}  // namespace

bool FrameSeries::add(Timestamp time, std::vector<std::complex<double>> values) {
  bool is_whole = true;
  if (const double usual = frames_.size() < kReliableFrames ? 0.0 : rate();
      usual > 0.0 && to_seconds(time - frames_.back().time) * usual > kMaxBridged) {
    frames_.clear();
    is_whole = false;
  }
  if (frames_.empty() || time > frames_.back().time) {
    frames_.push_back({time, std::move(values)});
  }
  return is_whole;
}

double FrameSeries::rate() const {
  if (frames_.size() < 3) {
    return 0.0;
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    steps.push_back(to_seconds(frames_[i].time - frames_[i - 1].time));
  }
  return 1.0 / median(std::move(steps));
}

std::optional<Timestamp> FrameSeries::first() const {
  return frames_.empty() ? std::nullopt : std::optional(frames_.front().time);
}

std::optional<Timestamp> FrameSeries::last() const {
  return frames_.empty() ? std::nullopt : std::optional(frames_.back().time);
}

std::optional<std::vector<std::complex<double>>> FrameSeries::at(Timestamp time) const {
  const auto after =
      std::lower_bound(frames_.begin(), frames_.end(), time, [](const Frame& frame, Timestamp t) {
        return frame.time < t;
      });
  if (after == frames_.end() || (after == frames_.begin() && after->time != time)) {
    return std::nullopt;
  }
  if (after->time == time) {
    return after->values;
  }
  const Frame& before = *(after - 1);
  const double share = to_seconds(time - before.time) / to_seconds(after->time - before.time);
  std::vector<std::complex<double>> values(before.values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = (1.0 - share) * before.values[i] + share * after->values[i];
  }
  return values;
}

void FrameSeries::forget_before(Timestamp time) {
  while (frames_.size() > 1 && frames_[1].time <= time) {
    frames_.pop_front();
  }
}

}  // namespace rayloc
