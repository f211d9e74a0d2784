#include "engine/likelihood/nearby_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/check.h"
#include "engine/likelihood/gain_profile.h"
#include "engine/likelihood/gaussian/whitened_gaussian.h"
#include "engine/likelihood/known_rays.h"
#include "engine/likelihood/min_power.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

// Number of search delays kept on each side of the best one.
constexpr std::size_t kDelaysBeside = 1;
constexpr double kNearbyLeftOut = 1e-6;  // share of the known power

// Explicit products: those of std::complex check for infinities.
Value times(const Value& a, const Value& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

LaneSums rotated(const LaneSums& row, std::complex<float> turn) {
  LaneSums result;
  for (std::size_t t = 0; t < kLaneCount; ++t) {
    result.re[t] = row.re[t] * turn.real() - row.im[t] * turn.imag();
    result.im[t] = row.re[t] * turn.imag() + row.im[t] * turn.real();
  }
  return result;
}

}  // namespace

NearbyLikelihood::NearbyLikelihood(const ObservationModel& observation_model,
                                   const ObservationModel::Place& place,
                                   const ModelError& error,
                                   const PlaceModel& model,
                                   const ObservedArray& observed)
    : size_(observation_model.dimension()),
      coordinates_(size_ / place.element_offset.size()),
      wave_number_(observation_model.wave_number()),
      model_(model) {
  RAYLOC_CHECK(model.reachable && !place.rays.empty());
  auto terms = observation_model.ray_terms(place, error);
  first_length_ = terms.first_length;
  means_ = std::move(terms.tone);
  std::vector<double> power(place.rays.size());  // power of the known part
  for (std::size_t p = 0; p < place.rays.size(); ++p) {
    for (std::size_t i = 0; i < coordinates_; ++i) {
      Value& mean = means_[p * coordinates_ + i];
      mean *= terms.parts[p].known;
      power[p] += std::norm(mean);
    }
  }
  single_means_.assign(means_.begin(), means_.end());
  keep_strongest(place, power);
  const std::size_t best = best_delay(model, observed);
  const std::size_t first = best > kDelaysBeside ? best - kDelaysBeside : 0;
  const std::size_t last = std::min(best + kDelaysBeside, ObservedArray::kDelays - 1);
  std::vector<Value> y(size_);
  for (std::size_t t = first; t <= last; ++t) {
    for (std::size_t i = 0; i < size_; ++i) {
      y[i] = observed.value(i, t);
    }
    Delay delay{whiten(model_, y), 0.0};
    for (const Value& v : delay.observed) {
      delay.power += std::norm(v);
    }
    delay.power = std::max(delay.power, kMinPower);
    observed_.insert(observed_.end(), delay.observed.begin(), delay.observed.end());
    delays_.push_back(std::move(delay));
  }
  keep_direct(observation_model.obstructable(place.rays));
}

NearbyLikelihood::NearbyLikelihood(const ObservationModel& observation_model,
                                   const ObservationModel::Place& place,
                                   const ModelError& error,
                                   std::unique_ptr<const PlaceModel> model,
                                   const ObservedArray& observed)
    : NearbyLikelihood(observation_model, place, error, *model, observed) {
  own_ = std::move(model);
}

// Most rays are uncertain or weak: the neglected power is far below the noise.
void NearbyLikelihood::keep_strongest(const ObservationModel::Place& place,
                                      std::span<const double> power) {
  const std::vector<std::size_t> kept = strongest(power, power.size(), kNearbyLeftOut);
  for (std::size_t m = 0; m < place.element_offset.size(); ++m) {
    for (const std::size_t p : kept) {
      sources_.push_back({image_of(place.rays[p], place.element_offset[m]), m, p * coordinates_});
    }
  }
}

// REQUIRES: sources and delays are set.
void NearbyLikelihood::keep_direct(std::size_t ray) {
  const std::size_t antennas = size_ / coordinates_;
  const std::size_t of_antenna = sources_.size() / antennas;
  while (direct_source_ < of_antenna && sources_[direct_source_].mean != ray * coordinates_) {
    ++direct_source_;
  }
  if (direct_source_ == of_antenna) {
    return;
  }
  for (std::size_t m = 0; m < antennas; ++m) {
    std::vector<Value> of(size_);
    std::copy_n(means_.begin() + static_cast<std::ptrdiff_t>(ray * coordinates_),
                coordinates_,
                of.begin() + static_cast<std::ptrdiff_t>(m * coordinates_));
    direct_.of.push_back(whiten(model_, of));
    observed_.insert(observed_.end(), direct_.of[m].begin(), direct_.of[m].end());
  }
  for (const Delay& delay : delays_) {
    for (const auto& of : direct_.of) {
      direct_.observed.emplace_back(inner_product(of, delay.observed));
    }
  }
  for (const auto& a : direct_.of) {
    for (const auto& b : direct_.of) {
      direct_.gram.emplace_back(inner_product(a, b));
    }
  }
}

NearbyLikelihood::Means NearbyLikelihood::means_at(const Vec3d& moved, bool obstructed) const {
  Means means{std::vector<Value>(size_), std::vector<Value>(size_), std::vector<Value>(size_)};
  const std::size_t of_antenna = sources_.size() / (size_ / coordinates_);
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    if (obstructed && s % of_antenna == direct_source_) {
      continue;
    }
    const Source& source = sources_[s];
    const Vec3d from_image = source.image - moved;
    const double length = norm(from_image);
    const Value phase = std::polar(1.0, -wave_number_ * (length - first_length_));
    // d phase = -j k d length, d length = -way / length
    const Value turn_x(0.0, wave_number_ * from_image.x / length);
    const Value turn_y(0.0, wave_number_ * from_image.y / length);
    for (std::size_t i = 0; i < coordinates_; ++i) {
      const Value one = times(phase, means_[source.mean + i]);
      means.value[source.antenna * coordinates_ + i] += one;
      means.by_x[source.antenna * coordinates_ + i] += times(turn_x, one);
      means.by_y[source.antenna * coordinates_ + i] += times(turn_y, one);
    }
  }
  return {whiten(model_, means.value), whiten(model_, means.by_x), whiten(model_, means.by_y)};
}

NearbyLikelihood::Slope NearbyLikelihood::slope(const Means& means) const {
  const auto d = static_cast<double>(size_);
  const Delay* best = &delays_.front();
  double best_value = -std::numeric_limits<double>::infinity();
  Value best_along;
  for (const Delay& delay : delays_) {
    const Value along = inner_product(means.value, delay.observed);
    const double value = gain_profile(delay.power, std::abs(along), d);
    if (value > best_value) {
      best = &delay;
      best_value = value;
      best_along = along;
    }
  }
  const double b = std::abs(best_along);
  const double r = best_gain(best->power, b, d);
  const Value turn = b > 0.0 ? std::conj(best_along) / b : Value();
  std::vector<Value> residual(size_);  // r e W y - W mu
  for (std::size_t i = 0; i < size_; ++i) {
    residual[i] = r * times(turn, best->observed[i]) - means.value[i];
  }
  return {best_value - inner_product(means.value, means.value).real() - model_.log_determinant,
          2.0 * inner_product(means.by_x, residual).real(),
          2.0 * inner_product(means.by_y, residual).real()};
}

NearbyLikelihood::Slope NearbyLikelihood::at(const Vec3d& moved) const {
  const Slope open = slope(means_at(moved, false));
  if (direct_.of.empty()) {
    return open;
  }
  Slope obstructed = slope(means_at(moved, true));
  obstructed.value += kLogObstructed;
  return obstructed.value > open.value ? obstructed : open;
}

PlaceModel NearbyLikelihood::model_at(const Vec3d& moved) const {
  PlaceModel place = model_;
  place.mean.clear();
  const auto append = [&](bool obstructed, PlaceModel::Powers& powers) {
    const std::vector<Value> mean = means_at(moved, obstructed).value;
    place.mean.insert(place.mean.end(), mean.begin(), mean.end());
    powers.whitened = static_cast<float>(power_of(mean));
    powers.inverse = static_cast<float>(power_of(unwhiten(model_, mean)));
  };
  append(false, place.open);
  if (!direct_.of.empty()) {
    append(true, place.obstructed);
  }
  return place;
}

std::vector<double> NearbyLikelihood::on(const Lattice& lattice, double raised) const {
  return on(lattice, Heights{raised, 0.0, 1});
}

std::vector<double> NearbyLikelihood::on(const Lattice& lattice, const Heights& heights) const {
  const std::size_t rows = (lattice.count_y + kLaneCount - 1) / kLaneCount;
  std::vector<Turning> turnings;
  turnings.reserve(sources_.size());
  for (const Source& source : sources_) {
    turnings.push_back(turning_of(source, lattice, heights));
  }
  Turns turns{std::vector<std::complex<float>>(sources_.size() * lattice.count_x),
              std::vector<LaneSums>(sources_.size() * rows)};
  std::vector<double> values(heights.count * lattice.size());
  for (std::size_t h = 0; h < heights.count; ++h) {
    take_turns(lattice, turnings, turns);
    values_on(lattice, turns, std::span(values).subspan(h * lattice.size(), lattice.size()));
  }
  return values;
}

// Log-likelihoods at one height.
void NearbyLikelihood::values_on(const Lattice& lattice,
                                 const Turns& turns,
                                 std::span<double> values) const {
  const std::size_t rows = (lattice.count_y + kLaneCount - 1) / kLaneCount;
  std::vector<LaneRow> re(size_);
  std::vector<LaneRow> im(size_);
  std::vector<RotatedMean> terms(sources_.size());
  const std::size_t antennas = size_ / coordinates_;
  const std::size_t of_antenna = sources_.size() / antennas;
  std::vector<LaneSums> direct(direct_.of.size());
  for (std::size_t x = 0; x < lattice.count_x; ++x) {
    for (std::size_t row = 0; row < rows; ++row) {
      std::fill(re.begin(), re.end(), LaneRow{});
      std::fill(im.begin(), im.end(), LaneRow{});
      for (std::size_t s = 0; s < sources_.size(); ++s) {
        terms[s] = {turns.by_x[s * lattice.count_x + x],
                    &turns.by_y[s * rows + row],
                    single_means_.data() + sources_[s].mean};
      }
      for (std::size_t m = 0; m < antennas; ++m) {
        add_rotated(std::span(terms).subspan(m * of_antenna, of_antenna),
                    std::span(re).subspan(m * coordinates_, coordinates_),
                    std::span(im).subspan(m * coordinates_, coordinates_));
      }
      for (std::size_t m = 0; m < direct.size(); ++m) {
        const RotatedMean& term = terms[m * of_antenna + direct_source_];
        direct[m] = rotated(*term.turns, term.turn);
      }
      const LaneRow chunk = log_likelihoods(re, im, direct);
      for (std::size_t t = 0; t < kLaneCount && row * kLaneCount + t < lattice.count_y; ++t) {
        values[x * lattice.count_y + row * kLaneCount + t] = static_cast<double>(chunk[t]);
      }
    }
  }
}

// exp(-j k (length - first)) at the first place and from place to place: by complex rotation, which
// is cheaper than a sine per place.
NearbyLikelihood::Turning NearbyLikelihood::turning_of(const Source& source,
                                                       const Lattice& lattice,
                                                       const Heights& heights) const {
  struct At {
    double phase;
    Vec3d slope;  // [rad/m]
  };
  const Vec3d corner = lattice.offset(0, 0);
  const auto at = [&](double raised) -> At {
    const Vec3d image = source.image - Vec3d{0.0, 0.0, raised};
    const double length = norm(image);
    const Vec3d slope = (wave_number_ / length) * image;
    return {-wave_number_ * (length - first_length_) + slope.x * corner.x + slope.y * corner.y,
            slope};
  };
  const At first = at(heights.first);
  Turning turning;
  turning.at = std::polar(1.0, first.phase);
  turning.step_x = std::polar(1.0, first.slope.x * lattice.step_x);
  turning.step_y = std::polar(1.0, first.slope.y * lattice.step_y);
  if (heights.count == 1) {
    return turning;
  }
  // phase(n) = first + a n + b n (n - 1), with n = last at the last height.
  const auto last = static_cast<double>(heights.count - 1);
  const At middle = at(heights.first + 0.5 * last * heights.step);
  const At end = at(heights.first + last * heights.step);
  const double square = 2.0 * (end.phase - 2.0 * middle.phase + first.phase) / (last * last);
  const double linear = (end.phase - first.phase) / last - square * last;
  turning.raised = std::polar(1.0, linear + square);
  turning.raised_again = std::polar(1.0, 2.0 * square);
  turning.raised_x = std::polar(1.0, (end.slope.x - first.slope.x) / last * lattice.step_x);
  turning.raised_y = std::polar(1.0, (end.slope.y - first.slope.y) / last * lattice.step_y);
  return turning;
}

// Phasors of one height; the next call returns those of the next height.
void NearbyLikelihood::take_turns(const Lattice& lattice,
                                  std::vector<Turning>& turnings,
                                  Turns& turns) {
  const std::size_t rows = (lattice.count_y + kLaneCount - 1) / kLaneCount;
  for (std::size_t s = 0; s < turnings.size(); ++s) {
    Turning& turning = turnings[s];
    Value turn = turning.at;
    for (std::size_t x = 0; x < lattice.count_x; ++x) {
      turns.by_x[s * lattice.count_x + x] = std::complex<float>(turn);
      turn = times(turn, turning.step_x);
    }
    turn = 1.0;
    for (std::size_t y = 0; y < rows * kLaneCount; ++y) {
      LaneSums& row = turns.by_y[s * rows + y / kLaneCount];
      row.re[y % kLaneCount] = static_cast<float>(turn.real());
      row.im[y % kLaneCount] = static_cast<float>(turn.imag());
      turn = times(turn, turning.step_y);
    }
    turning.at = times(turning.at, turning.raised);
    turning.raised = times(turning.raised, turning.raised_again);
    turning.step_x = times(turning.step_x, turning.raised_x);
    turning.step_y = times(turning.step_y, turning.raised_y);
  }
}

LaneRow NearbyLikelihood::log_likelihoods(std::span<const LaneRow> re,
                                          std::span<const LaneRow> im,
                                          std::span<const LaneSums> direct) const {
  std::vector<LaneSums> along(delays_.size() + direct.size());
  const LaneRow power = whiten(model_.whitener.data(), re, im, observed_, along);
  LaneRow values = best_of_delays(power, std::span(along).first(delays_.size()));
  if (!direct.empty()) {
    const LaneRow less = obstructed_power(power, std::span(along).subspan(delays_.size()), direct);
    for (std::size_t k = 0; k < delays_.size(); ++k) {
      take_direct(k, direct, along[k]);
    }
    const LaneRow obstructed = best_of_delays(less, std::span(along).first(delays_.size()));
    for (std::size_t t = 0; t < kLaneCount; ++t) {
      values[t] = std::max(values[t], obstructed[t] + static_cast<float>(kLogObstructed));
    }
  }
  for (float& value : values) {
    value -= static_cast<float>(model_.log_determinant);
  }
  return values;
}

// power: of the mean; along: (W mu)^H W y, [delay].
LaneRow NearbyLikelihood::best_of_delays(const LaneRow& power,
                                         std::span<const LaneSums> along) const {
  LaneRow values{};
  for (std::size_t k = 0; k < delays_.size(); ++k) {
    LaneRow observed;
    observed.fill(static_cast<float>(delays_[k].power));
    const LaneRow of_delay = at_best_gain(observed, along[k], size_);
    for (std::size_t t = 0; t < kLaneCount; ++t) {
      values[t] = k == 0 ? of_delay[t] : std::max(values[t], of_delay[t]);
    }
  }
  for (std::size_t t = 0; t < kLaneCount; ++t) {
    values[t] -= power[t];
  }
  return values;
}

// |W mu - W d|^2; along: (W mu)^H w_m, [antenna].
LaneRow NearbyLikelihood::obstructed_power(const LaneRow& power,
                                           std::span<const LaneSums> along,
                                           std::span<const LaneSums> direct) const {
  LaneRow result = power;
  for (std::size_t m = 0; m < direct.size(); ++m) {
    for (std::size_t t = 0; t < kLaneCount; ++t) {
      result[t] -= 2.0F * (along[m].re[t] * direct[m].re[t] - along[m].im[t] * direct[m].im[t]);
    }
    for (std::size_t n = 0; n < direct.size(); ++n) {
      const std::complex<float> g = direct_.gram[m * direct.size() + n];
      for (std::size_t t = 0; t < kLaneCount; ++t) {
        // The real part of conj(t_m) g t_n: the sum over all m and n is real.
        const float re = direct[m].re[t] * direct[n].re[t] + direct[m].im[t] * direct[n].im[t];
        const float im = direct[m].re[t] * direct[n].im[t] - direct[m].im[t] * direct[n].re[t];
        result[t] += re * g.real() - im * g.imag();
      }
    }
  }
  return result;
}

// (W mu - W d)^H W y of delay k from (W mu)^H W y.
void NearbyLikelihood::take_direct(std::size_t k,
                                   std::span<const LaneSums> direct,
                                   LaneSums& along) const {
  for (std::size_t m = 0; m < direct.size(); ++m) {
    const std::complex<float> g = direct_.observed[k * direct.size() + m];
    for (std::size_t t = 0; t < kLaneCount; ++t) {
      // conj(t_m) g
      along.re[t] -= direct[m].re[t] * g.real() + direct[m].im[t] * g.imag();
      along.im[t] -= direct[m].re[t] * g.imag() - direct[m].im[t] * g.real();
    }
  }
}

}  // namespace rayloc
