#include "engine/baselines/widar2/widar2.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "engine/base/constants.h"
#include "engine/baselines/motion/band_pass.h"
#include "engine/baselines/motion/conjugate_product.h"
#include "engine/baselines/paths/tone_comb.h"
#include "engine/baselines/paths/turn.h"
#include "engine/baselines/plan_map.h"
#include "engine/observe/chain_gains.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr double kLowest = 2.0;             // [Hz], of the band of motion, as published
constexpr double kHighest = 50.0;           // [Hz], as published
constexpr double kMaxOfBand = 0.45;         // of the frame rate, if that is less
constexpr double kBefore = 1.5;             // [s], before a window, for the filter to settle
constexpr double kAfter = 0.5;              // [s], the same after it
constexpr double kWidar2StillTime = 1.0;    // [s], without motion: no estimate
constexpr double kWidar2MotionRatio = 2.0;  // energy of the band over that of noise, 3 dB
constexpr double kMinDetour = 0.1;          // [m], of a path via a person
constexpr std::size_t kMinSamples = 10;     // of a window, a count, chosen
constexpr double kOutlier = 0.1;            // a probability, chosen: wrong path

Vec3d in_plan(const Vec3d& v) { return {v.x, v.y, 0.0}; }

// Mean over the rows of the energy of the band relative to that of the noise, which is estimated
// from differences of neighbours.
bool is_moving(const Eigen::MatrixXcd& raw, const Eigen::MatrixXcd& band) {
  const Eigen::Index n = raw.cols();
  const double noise =
      0.5 * (raw.rightCols(n - 1) - raw.leftCols(n - 1)).squaredNorm() / static_cast<double>(n - 1);
  return band.squaredNorm() / static_cast<double>(n) > kWidar2MotionRatio * noise;
}

}  // namespace

double range_of(double length, const Vec3d& to_transmitter, const Vec3d& direction) {
  const double along = to_transmitter.x * direction.x + to_transmitter.y * direction.y;
  const double square = to_transmitter.x * to_transmitter.x + to_transmitter.y * to_transmitter.y;
  return length > along ? (length * length - square) / (2.0 * (length - along)) : -1.0;
}

Widar2::Widar2(std::shared_ptr<const RoomModel> room, Widar2Link link, const Widar2Options& options)
    : room_(std::move(room)), link_(std::move(link)), options_(options) {}

Expected<Widar2> Widar2::create(std::shared_ptr<const RoomModel> room,
                                Widar2Link link,
                                const Widar2Options& options) {
  RAYLOC_TRY(check_room(room.get()));
  const auto comb = tone_comb(room->grid);
  if (comb.tone.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      "widar2 needs tones in equal steps on both sides of the channel's centre; "
                      "the site's [carrier] has none");
  }
  const std::vector<std::size_t> all = link.access_points;
  Widar2 made(std::move(room), std::move(link), options);
  made.tones_ = comb.tone;
  std::string why;
  for (const std::size_t i : all) {
    const RoomAccessPoint& ap = made.room_->access_points[i];
    std::vector<std::size_t> elements(ap.rx_chains.size());
    std::iota(elements.begin(), elements.end(), std::size_t{0});
    const std::string problem = calibration_problem(*made.room_, ap);
    auto line = antenna_line(ap.array, elements);
    if (problem.empty() && line) {
      RangeSmootherOptions range;
      range.rate_sigma = options.rate_sigma;
      range.lag = options.windows;
      range.least = norm(in_plan(made.link_.position - ap.array.pose.position)) + kMinDetour;
      made.receivers_.push_back({.access_point = i,
                                 .line = *std::move(line),
                                 .series = {},
                                 .link = PathLink(options.windows),
                                 .range = RangeSmoother(range)});
      continue;
    }
    why = problem.empty() ? ap.id + " has " + std::to_string(elements.size()) + " usable antenna" +
                                (elements.size() == 1 ? "" : "s") + ": a bearing needs 2 in a line"
                          : "access point " + ap.id + " " + problem;
  }
  if (made.receivers_.empty()) {
    return make_error(
        ErrorKind::kConfiguration,
        why.empty() ? "widar2 needs an access point that receives the transmitter" : why);
  }
  return made;
}

void Widar2::begin_anew(Receiver& receiver) const {
  receiver.link.clear();
  receiver.range.clear();
  receiver.psi.clear();
  receiver.still_s = 0.0;
}

void Widar2::restart() {
  for (Receiver& receiver : receivers_) {
    receiver.series.clear();
    receiver.sage.reset();
    receiver.sample = {};
    begin_anew(receiver);
  }
  window_.reset();
  problem_.clear();
}

// Phases are relative to the first antenna of the line: the common phase is removed, and the rest
// changes slowly enough to be interpolated.
void Widar2::take(const CsiFrame& frame) {
  const auto found = std::find_if(receivers_.begin(), receivers_.end(), [&](const Receiver& one) {
    return one.access_point == frame.access_point;
  });
  if (found == receivers_.end()) {
    return;
  }
  const RoomAccessPoint& ap = room_->access_points[found->access_point];
  auto one = combine_burst({&frame, 1}, {frame.access_point, room_->grid, ap.rx_chains, {}});
  if (!one) {
    return;
  }
  remove_gains(ap.gains, one->h);
  std::vector<std::complex<double>> values;
  const std::vector<std::size_t>& elements = found->line.element;
  for (const std::size_t element : elements) {
    for (const std::size_t k : tones_) {
      const std::complex<double> first = one->value(elements.front(), k);
      const double size = std::abs(first);
      values.push_back(size > 0.0 ? one->value(element, k) * std::conj(first) / size : 0.0);
    }
  }
  if (!found->series.add(frame.time, std::move(values))) {
    begin_anew(*found);
  }
}

// [antenna * tones + tone][instant].
Eigen::MatrixXcd Widar2::samples_of(const Receiver& receiver, Timestamp from, Timestamp to) const {
  const auto count = static_cast<Eigen::Index>((to - from) / receiver.sample);
  const auto rows = static_cast<Eigen::Index>(receiver.line.element.size() * tones_.size());
  Eigen::MatrixXcd h(rows, count);
  for (Eigen::Index t = 0; t < count; ++t) {
    const auto values = receiver.series.at(from + static_cast<std::int64_t>(t) * receiver.sample);
    for (Eigen::Index i = 0; i < rows; ++i) {
      h(i, t) = values ? (*values)[static_cast<std::size_t>(i)]
                       : (t == 0 ? std::complex<double>() : h(i, t - 1));
    }
  }
  return h;
}

// True if the frame rate of all active receivers is sufficient.
bool Widar2::is_ready() {
  const double wavelength = kSpeedOfLight / room_->grid.centre_hz;
  const double least = options_.least_rate_hz(wavelength);
  bool any = false;
  for (Receiver& receiver : receivers_) {
    const auto first = receiver.series.first();
    const auto last = receiver.series.last();
    if (!first || (receiver.sample == Duration{} && to_seconds(*last - *first) < kBefore)) {
      continue;
    }
    const double rate = receiver.series.rate();
    if (rate < least) {
      problem_ = std::to_string(std::lround(rate)) + " frames/s of " +
                 to_string(link_.transmitter) + " at " +
                 room_->access_points[receiver.access_point].id + ": widar2 needs " +
                 std::to_string(std::lround(std::ceil(least))) +
                 " (4 v_max / wavelength); send more often, or lower v_max";
      return false;
    }
    if (receiver.sample == Duration{}) {
      receiver.sample = from_seconds(1.0 / rate);
    }
    any = true;
  }
  return any;
}

// True if frames beyond the window have been received for long enough.
bool Widar2::is_complete(Timestamp window) const {
  const Timestamp needed = window + from_seconds(options_.window_s + kAfter);
  Timestamp latest{};
  for (const Receiver& receiver : receivers_) {
    if (const auto last = receiver.series.last()) {
      latest = std::max(latest, *last);
    }
  }
  return latest >= needed;
}

std::optional<Widar2::Received> Widar2::receive_window(Receiver& receiver, Timestamp window) {
  const auto first = receiver.series.first();
  const auto last = receiver.series.last();
  const Duration length = from_seconds(options_.window_s);
  if (receiver.sample == Duration{} || !first || *first > window ||
      *last < window + length + from_seconds(0.5 * kAfter)) {
    return std::nullopt;
  }
  const auto back = std::min(window - *first, from_seconds(kBefore)) / receiver.sample;
  const Timestamp from = window - back * receiver.sample;
  const Timestamp to = std::min(*last, window + length + from_seconds(kAfter));
  const ConjugateProduct made =
      conjugate_product(samples_of(receiver, from, to), receiver.line.element.size());
  if (made.product.cols() <= static_cast<Eigen::Index>(BandPass::kContinued)) {
    return std::nullopt;
  }
  const double rate = 1.0 / to_seconds(receiver.sample);
  const BandPass filter(kLowest, std::min(kHighest, kMaxOfBand * rate), rate);
  Eigen::MatrixXcd band(made.product.rows(), made.product.cols());
  for (Eigen::Index i = 0; i < band.rows(); ++i) {
    const Eigen::VectorXcd row = made.product.row(i).transpose();
    const auto passed = filter.filtered({row.data(), static_cast<std::size_t>(row.size())});
    band.row(i) = Eigen::Map<const Eigen::RowVectorXcd>(passed.data(), row.size());
  }
  receiver.still_s = is_moving(made.product, band) ? 0.0 : receiver.still_s + options_.window_s;
  const double wavelength = kSpeedOfLight / room_->grid.centre_hz;
  if (!receiver.sage) {
    std::vector<double> tone_hz;
    for (const std::size_t k : tones_) {
      tone_hz.push_back(room_->grid.frequency_hz(k) - room_->grid.centre_hz);
    }
    const auto samples = std::max<std::int64_t>(length / receiver.sample, kMinSamples);
    receiver.sage.emplace(std::move(tone_hz),
                          receiver.line.element.size(),
                          static_cast<std::size_t>(samples),
                          to_seconds(receiver.sample),
                          wavelength,
                          options_.sage);
  }
  const auto samples = static_cast<Eigen::Index>(receiver.sage->instants());
  if (back + samples > band.cols()) {
    return std::nullopt;
  }
  const auto target =
      receiver.link.add(receiver.sage->paths(band.middleCols(back, samples), made.reference));
  if (!target) {
    return std::nullopt;
  }
  const double direct = norm(
      in_plan(link_.position - room_->access_points[receiver.access_point].array.pose.position));
  receiver.range.add(target->rate, options_.window_s, direct + kSpeedOfLight * target->delay);
  receiver.psi.push_back(target->psi);
  if (!receiver.range.is_ready()) {
    return std::nullopt;
  }
  const Received received{&receiver, receiver.range.smoothed(), receiver.psi.front()};
  receiver.psi.erase(receiver.psi.begin());
  return receiver.still_s < kWidar2StillTime ? std::optional(received) : std::nullopt;
}

LocationEstimate Widar2::estimate(std::span<const Received> received, Timestamp time) const {
  const double wavelength = kSpeedOfLight / room_->grid.centre_hz;
  LocationEstimate estimate;
  estimate.time = estimate.capture_start = estimate.capture_end = time;
  estimate.access_points_used = received.size();
  PlanMapOptions map;
  map.step = options_.grid;
  map.accuracy_confidence = options_.accuracy_confidence;
  map.outlier = kOutlier;
  summarise_plan(
      *room_,
      map,
      [&](const Vec3d& place) {
        double sum = 0.0;
        for (const Received& one : received) {
          const AntennaArray& array = room_->access_points[one.receiver->access_point].array;
          const double length =
              norm(in_plan(place - link_.position)) + norm(in_plan(place - array.pose.position));
          const double off = length - one.range.length;
          const double rotated =
              wrapped(one.psi - psi_of(array, one.receiver->line, place, wavelength));
          // The echo originates anywhere around the axis of the body.
          const double away = std::max(options_.body, norm(in_plan(place - array.pose.position)));
          const double aside = 2.0 * std::numbers::pi * one.receiver->line.spacing / wavelength *
                               options_.body / away;
          sum -=
              0.5 * off * off / (one.range.variance + options_.body * options_.body) +
              0.5 * rotated * rotated / (options_.sigma_psi * options_.sigma_psi + aside * aside);
        }
        return sum;
      },
      estimate);
  if (estimate.position) {
    estimate.position->z = 0.0;
  }
  return estimate;
}

void Widar2::receive(std::span<const CsiFrame> frames, std::vector<LocationEstimate>& out) {
  for (const CsiFrame& frame : frames) {
    take(frame);
  }
  problem_.clear();
  if (!is_ready()) {
    return;
  }
  const Duration length = from_seconds(options_.window_s);
  if (!window_) {
    for (const Receiver& receiver : receivers_) {
      if (const auto first = receiver.series.first()) {
        window_ = window_ ? std::min(*window_, *first) : *first;
      }
    }
  }
  for (; is_complete(*window_); *window_ += length) {
    std::vector<Received> received;
    for (Receiver& receiver : receivers_) {
      if (const auto one = receive_window(receiver, *window_)) {
        received.push_back(*one);
      }
    }
    if (!received.empty()) {
      // The current output belongs to the middle of an earlier window.
      const auto behind = static_cast<std::int64_t>(2 * options_.windows);
      out.push_back(estimate(received, *window_ - behind * length + length / 2));
    }
  }
  const bool all_still =
      std::all_of(receivers_.begin(), receivers_.end(), [&](const Receiver& receiver) {
        return receiver.still_s >= kWidar2StillTime || receiver.sample == Duration{};
      });
  if (all_still) {
    problem_ = "nothing moves: widar2 sees only what moves";
  }
  for (Receiver& receiver : receivers_) {
    receiver.series.forget_before(*window_ - from_seconds(kBefore));
  }
}

}  // namespace rayloc
