#include "engine/baselines/witraj/witraj.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/constants.h"
#include "engine/base/median.h"
#include "engine/baselines/paths/tone_comb.h"
#include "engine/baselines/witraj/plan_step.h"
#include "engine/observe/chain_gains.h"
#include "engine/observe/csi_ratio.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr std::size_t kTones = 12;          // tones that vote, a count, of the published release
constexpr double kBeginning = 1.0;          // [s], time to determine the stronger antenna
constexpr double kWitrajStillTime = 0.5;    // [s], without motion: the place is held
constexpr double kWitrajMotionRatio = 2.0;  // variance of a ratio over that of its noise, 3 dB
constexpr double kMotionWindow = 0.1;       // [s], on each side
constexpr double kInlier = 0.97;  // probability of the Gaussian; RayLoc's outlier share is 0.03
// The two of the published release, in seconds.
constexpr std::array kRateSmoothings = {PathRateOptions{0.0275, 0.15},
                                        PathRateOptions{0.0425, 0.24}};

// Evenly spaced tones of a comb.
std::vector<std::size_t> voting_tones(const OfdmGrid& grid) {
  const ToneComb comb = tone_comb(grid);
  std::vector<std::size_t> tones;
  for (std::size_t i = 0; i < kTones && !comb.tone.empty(); ++i) {
    tones.push_back(comb.tone[i * comb.tone.size() / kTones]);
  }
  return tones;
}

double variance(std::span<const std::complex<double>> values) {
  const auto count = static_cast<double>(values.size());
  const auto mean = std::accumulate(values.begin(), values.end(), std::complex<double>()) / count;
  double sum = 0.0;
  for (const auto& value : values) {
    sum += std::norm(value - mean);
  }
  return sum / count;
}

// Half of the power of the differences between neighbours: the noise power.
double noise_of(std::span<const std::complex<double>> values) {
  double sum = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    sum += 0.5 * std::norm(values[i] - values[i - 1]);
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, values.size() - 1));
}

}  // namespace

Witraj::Witraj(std::shared_ptr<const RoomModel> room,
               WitrajLink link,
               const Vec3d& start,
               const WitrajOptions& options)
    : room_(std::move(room)), link_(std::move(link)), options_(options), start_(start) {
  restart();
}

void Witraj::restart() {
  for (Receiver& receiver : receivers_) {
    receiver.series.clear();
    receiver.power = {};
    receiver.of_tone.assign(receiver.tones.size(), {});
    receiver.frames = 0;
  }
  sample_ = {};
  time_.reset();
  place_ = {start_.x, start_.y, 0.0};
  const double variance = options_.start_sigma * options_.start_sigma;
  covariance_ = {variance, 0.0, 0.0, variance};
  still_s_ = 0.0;
  cut_ = gaps_ = 0;
  problem_.clear();
}

Expected<Witraj> Witraj::create(std::shared_ptr<const RoomModel> room,
                                WitrajLink link,
                                std::optional<Vec3d> start,
                                const WitrajOptions& options) {
  RAYLOC_TRY(check_room(room.get()));
  if (!start) {
    return make_error(ErrorKind::kUsage,
                      "--method witraj adds steps to a known start: give --start X,Y");
  }
  const auto tones = voting_tones(room->grid);
  if (tones.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      "witraj needs tones in equal steps on both sides of the channel's centre; "
                      "the site's [carrier] has none");
  }
  const std::vector<std::size_t> all = link.access_points;
  Witraj made(std::move(room), std::move(link), *start, options);
  std::string names;
  for (const std::size_t i : all) {
    const RoomAccessPoint& ap = made.room_->access_points[i];
    std::vector<std::size_t> elements(ap.rx_chains.size());
    std::iota(elements.begin(), elements.end(), std::size_t{0});
    auto line = antenna_line(ap.array, elements);
    if (calibration_problem(*made.room_, ap).empty() && line) {
      made.receivers_.push_back({i,
                                 *std::move(line),
                                 tones,
                                 {},
                                 {},
                                 std::vector<std::array<double, 2>>(tones.size()),
                                 0});
      names += (names.empty() ? "" : ", ") + ap.id;
    }
  }
  if (made.receivers_.size() < 2) {
    return make_error(ErrorKind::kConfiguration,
                      "witraj needs 2 access points that receive one transmitter, 3 to drop the "
                      "worst; the site has " +
                          (names.empty() ? "none" : names));
  }
  return made;
}

// The ratio of the outer antennas and its inverse, with the floor of csi_ratio().
void Witraj::take(const CsiFrame& frame) {
  const auto found = std::find_if(receivers_.begin(), receivers_.end(), [&](const Receiver& one) {
    return one.access_point == frame.access_point;
  });
  if (found == receivers_.end()) {
    return;
  }
  Receiver& receiver = *found;
  const RoomAccessPoint& ap = room_->access_points[receiver.access_point];
  BurstRequest request{frame.access_point, room_->grid, ap.rx_chains, {}};
  auto one = combine_burst({&frame, 1}, request);
  if (!one) {
    return;
  }
  remove_gains(ap.gains, one->h);
  const std::array rows = {receiver.line.element.front(), receiver.line.element.back()};
  std::array<double, 2> power{};
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t k = 0; k < one->grid.size(); ++k) {
      power.at(side) +=
          std::norm(one->value(rows.at(side), k)) / static_cast<double>(one->grid.size());
    }
    receiver.power.at(side) += std::sqrt(power.at(side));
    for (std::size_t i = 0; i < receiver.tones.size(); ++i) {
      receiver.of_tone[i].at(side) += std::abs(one->value(rows.at(side), receiver.tones[i]));
    }
  }
  std::vector<std::complex<double>> ratios;
  for (std::size_t side = 0; side < 2; ++side) {  // denominator: antenna `side`
    for (const std::size_t k : receiver.tones) {
      const auto below = one->value(rows.at(side), k);
      const auto above = one->value(rows.at(1 - side), k);
      ratios.push_back(above * std::conj(below) /
                       (std::norm(below) + kRatioFloor * power.at(side)));
    }
  }
  ++receiver.frames;
  if (!receiver.series.add(frame.time, std::move(ratios)) && time_) {
    ++gaps_;
    const double away = options_.v_max * to_seconds(frame.time - *time_);
    covariance_[0] += away * away;
    covariance_[3] += away * away;
    time_ = frame.time;
  }
}

// True if all access points in use have enough frames at a sufficient rate.
bool Witraj::is_ready() {
  for (const Receiver& receiver : receivers_) {
    const auto first = receiver.series.first();
    const auto last = receiver.series.last();
    if (!first || (!time_ && to_seconds(*last - *first) < kBeginning)) {
      return false;
    }
    const double rate = receiver.series.rate();
    if (rate < options_.least_rate_hz) {
      problem_ = std::to_string(std::lround(rate)) + " frames/s of " +
                 to_string(link_.transmitter) + " at " +
                 room_->access_points[receiver.access_point].id + ": witraj needs " +
                 std::to_string(std::lround(options_.least_rate_hz)) +
                 " (5 frames in a window of 27.5 ms); send more often";
      return false;
    }
  }
  problem_.clear();
  return true;
}

Witraj::Rates Witraj::rates_of(const Receiver& receiver,
                               Timestamp from,
                               std::size_t samples) const {
  // The weaker antenna is the numerator.
  const auto offset = [&](std::size_t tone) {
    const auto& power = options_.by_tone ? receiver.of_tone[tone] : receiver.power;
    return power[0] >= power[1] ? std::size_t{0} : receiver.tones.size();
  };
  std::vector<std::vector<std::complex<double>>> ratio(receiver.tones.size());
  for (std::size_t n = 0; n < samples; ++n) {
    const auto values = receiver.series.at(from + static_cast<std::int64_t>(n) * sample_);
    for (std::size_t k = 0; k < ratio.size(); ++k) {
      ratio[k].push_back(values ? (*values)[offset(k) + k]
                                : (n == 0 ? std::complex<double>() : ratio[k].back()));
    }
  }
  const double wavelength = kSpeedOfLight / room_->grid.centre_hz;
  const double step_s = to_seconds(sample_);
  std::vector<std::vector<PathRate>> of_tone;
  for (const auto& values : ratio) {
    std::vector<PathRate> best = path_rates(values, step_s, wavelength, kRateSmoothings[0]);
    const auto other = path_rates(values, step_s, wavelength, kRateSmoothings[1]);
    for (std::size_t n = 0; n < samples; ++n) {
      best[n] = other[n].score > best[n].score ? other[n] : best[n];
    }
    of_tone.push_back(std::move(best));
  }
  Rates rates;
  const auto half = static_cast<std::size_t>(kMotionWindow / step_s);
  std::vector<double> votes(of_tone.size());
  std::vector<double> scores(of_tone.size());
  for (std::size_t n = 0; n < samples; ++n) {
    for (std::size_t k = 0; k < of_tone.size(); ++k) {
      votes[k] = of_tone[k][n].rate;
      scores[k] = of_tone[k][n].score;
    }
    rates.of_sample.push_back({median(votes), median(scores)});
    const std::size_t begin = n < half ? 0 : n - half;
    const std::size_t end = std::min(samples, n + half + 1);
    double spread = 0.0;
    double noise = 0.0;
    for (const auto& values : ratio) {
      const auto window = std::span(values).subspan(begin, end - begin);
      spread += variance(window);
      noise += noise_of(window);
    }
    rates.is_moving.push_back(spread > kWitrajMotionRatio * noise ? 1 : 0);
  }
  return rates;
}

void Witraj::step(std::span<const Rates> rates,
                  std::size_t first,
                  std::vector<LocationEstimate>& out) {
  const double seconds = static_cast<double>(kStepSamples) * to_seconds(sample_);
  struct Mean {
    PathRateAt at;
    double score = 0.0;
  };
  std::vector<Mean> means;
  std::size_t moving = 0;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    Mean mean{{room_->access_points[receivers_[i].access_point].array.pose.position, 0.0}, 0.0};
    for (std::size_t n = first; n < first + kStepSamples; ++n) {
      mean.at.rate += rates[i].of_sample[n].rate / static_cast<double>(kStepSamples);
      mean.score += rates[i].of_sample[n].score;
    }
    moving += rates[i].is_moving[first + kStepSamples / 2] != 0 ? 1U : 0U;
    means.push_back(mean);
  }
  if (means.size() > 2 && options_.drops_worst) {
    means.erase(std::min_element(means.begin(), means.end(), [](const Mean& a, const Mean& b) {
      return a.score < b.score;
    }));
  }
  still_s_ = moving > 0 ? 0.0 : still_s_ + seconds;
  std::vector<PathRateAt> kept;
  kept.reserve(means.size());
  for (const Mean& mean : means) {
    kept.push_back(mean.at);
  }
  if (still_s_ < kWitrajStillTime) {
    PlanStep step = plan_step(link_.position, kept, place_, seconds);
    const double length = std::hypot(step.x, step.y);
    const double most = options_.v_max * seconds;
    const double scale = length > most ? most / length : 1.0;
    const Vec3d next{
        std::clamp(place_.x + scale * step.x, room_->bounds_min.x, room_->bounds_max.x),
        std::clamp(place_.y + scale * step.y, room_->bounds_min.y, room_->bounds_max.y),
        0.0};
    cut_ +=
        scale < 1.0 || next.x != place_.x + scale * step.x || next.y != place_.y + scale * step.y
            ? 1U
            : 0U;
    place_ = next;
    // The error of a rate persists for longer than a step.
    const double grows = options_.sigma_v * options_.sigma_v * options_.rate_memory_s / seconds;
    for (std::size_t i = 0; i < covariance_.size(); ++i) {
      covariance_.at(i) += grows * step.by_rate.at(i);
    }
  }
  *time_ += static_cast<std::int64_t>(kStepSamples) * sample_;
  out.push_back(estimate());
}

LocationEstimate Witraj::estimate() const {
  LocationEstimate estimate;
  estimate.position = place_;
  estimate.covariance = {
      covariance_[0], covariance_[1], 0.0, covariance_[2], covariance_[3], 0.0, 0.0, 0.0, 1e-6};
  const double middle = 0.5 * (covariance_[0] + covariance_[3]);
  const double half = std::hypot(0.5 * (covariance_[0] - covariance_[3]), covariance_[1]);
  estimate.accuracy_confidence = options_.accuracy_confidence;
  // A circle around the ellipse: never too small.
  estimate.accuracy_m =
      std::sqrt(-2.0 * std::log(1.0 - options_.accuracy_confidence) * (middle + half));
  estimate.hypotheses = {{place_, estimate.covariance, kInlier}};
  estimate.residual_probability = 1.0 - kInlier;
  estimate.time = estimate.capture_start = estimate.capture_end = *time_;
  estimate.access_points_used = receivers_.size();
  if (still_s_ >= kWitrajStillTime) {
    estimate.warnings.emplace_back("nothing moves: the place is held");
  }
  if (cut_ > 0) {
    estimate.warnings.push_back(std::to_string(cut_) +
                                " steps were longer than v_max or left the room, and cut");
  }
  if (gaps_ > 0) {
    estimate.warnings.push_back(std::to_string(gaps_) +
                                " gaps in the received frames: no steps there");
  }
  return estimate;
}

void Witraj::process(std::vector<LocationEstimate>& out) {
  Timestamp begin = *receivers_.front().series.first();
  Timestamp end = *receivers_.front().series.last();
  for (const Receiver& receiver : receivers_) {
    begin = std::max(begin, *receiver.series.first());
    end = std::min(end, *receiver.series.last());
  }
  if (!time_) {
    sample_ = from_seconds(1.0 / receivers_.front().series.rate());
    time_ = begin;
  }
  const Duration step_time = static_cast<std::int64_t>(kStepSamples) * sample_;
  if (end - kLag - *time_ < step_time) {
    return;
  }
  time_ = std::max(*time_, begin);
  // Windows of all access points on a common time grid, which contains the state's time.
  const auto before = std::min((*time_ - begin) / sample_, kLag / sample_);
  const Timestamp from = *time_ - before * sample_;
  const auto samples = static_cast<std::size_t>((end - from) / sample_) + 1;
  std::vector<Rates> rates;
  for (const Receiver& receiver : receivers_) {
    rates.push_back(rates_of(receiver, from, samples));
  }
  for (auto first = static_cast<std::size_t>(before); *time_ + step_time <= end - kLag;
       first += kStepSamples) {
    step(rates, first, out);
  }
  for (Receiver& receiver : receivers_) {
    receiver.series.forget_before(*time_ - 2 * kLag);
  }
}

void Witraj::receive(std::span<const CsiFrame> frames, std::vector<LocationEstimate>& out) {
  for (const CsiFrame& frame : frames) {
    take(frame);
  }
  if (is_ready()) {
    process(out);
  }
}

}  // namespace rayloc
