#include "engine/likelihood/observation_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Core>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/likelihood/burst_noise.h"
#include "engine/likelihood/min_power.h"
#include "engine/likelihood/place_moments.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;
using Eigen::Index;

// Decays between the tabulated ones, which are kDiffuseDecay times powers of 2^(1/4), are mixtures
// of the two neighbours.
constexpr int kDecaysBelow = 8;
constexpr int kDecaysAbove = 8;            // a count, chosen: two octaves on either side
constexpr double kDecaysAnOctave = 4.0;    // a count: makes the factor 2^(1/4)
constexpr double kDiffuseReference = 3.0;  // [m]
// Uncertainty of a ray's power by number of reflections (materials, thickness).
constexpr std::array<double, 4> kStrengthVariance = {0.02, 0.1, 0.2, 0.3};

double strength_variance(int reflections) {
  return kStrengthVariance[std::min<std::size_t>(static_cast<std::size_t>(reflections),
                                                 kStrengthVariance.size() - 1)];
}

// The ray that arrives first.
const Ray& first_of(std::span<const Ray> rays) {
  return *std::min_element(
      rays.begin(), rays.end(), [](const Ray& a, const Ray& b) { return a.length < b.length; });
}

// For every delay of a block: 2 D ln r - r^2 |W y|^2 + 2 r |(W mu)^H W y| - |W mu|^2 at the best
// gain r, with the line of sight clear and obstructed.
struct Profile {
  LaneRow open;
  LaneRow obstructed;  // with its prior probability; lowest() if there is none
};

Profile profile(const PlaceModel& place, const ObservedArray::Block& block) {
  const std::size_t size = block.re.size();
  const std::size_t means = place.mean.size() / size;
  std::array<LaneSums, 2> along;  // (W y)^H W mu
  LaneRow power =
      whiten(place.whitener.data(), block.re, block.im, place.mean, std::span(along).first(means));
  for (float& one : power) {
    one = std::max(one, kMinSinglePower);
  }
  Profile result{at_best_gain(power, along[0], size), {}};
  for (float& value : result.open) {
    value -= place.open.whitened;
  }
  if (means > 1) {
    result.obstructed = at_best_gain(power, along[1], size);
    for (float& value : result.obstructed) {
      value += static_cast<float>(kLogObstructed) - place.obstructed.whitened;
    }
  } else {
    result.obstructed.fill(std::numeric_limits<float>::lowest());
  }
  return result;
}

// The larger of both, per delay.
LaneRow better(const PlaceModel& place, const ObservedArray::Block& block) {
  Profile both = profile(place, block);
  for (std::size_t i = 0; i < both.open.size(); ++i) {
    both.open[i] = std::max(both.open[i], both.obstructed[i]);
  }
  return both.open;
}

// Calls `call` with every selected window and the likelihoods of its delays.
template <typename Call>
void for_windows(const PlaceModel& place,
                 const ObservedArray& observed,
                 std::uint8_t windows,
                 const Call& call) {
  for (std::size_t w = 0; w < ObservedArray::kWindows; ++w) {
    if ((windows >> w & 1U) != 0) {
      call(w, better(place, observed.windows[w]));
    }
  }
}

}  // namespace

std::size_t best_delay(const PlaceModel& place, const ObservedArray& observed) {
  std::size_t best = 0;
  float top = std::numeric_limits<float>::lowest();
  const std::uint8_t windows = ObservationModel::coarse(place, observed).windows;
  for_windows(place, observed, windows, [&](std::size_t w, const LaneRow& values) {
    const auto peak = std::max_element(values.begin(), values.end());
    if (*peak > top) {
      top = *peak;
      best = ObservedArray::first_of(w) + static_cast<std::size_t>(peak - values.begin());
    }
  });
  return best;
}

ObservationModel::ObservationModel(const OfdmGrid& grid,
                                   std::size_t antennas,
                                   PathKnowledge knowledge)
    : grid_(grid),
      antennas_(antennas),
      knowledge_(knowledge),
      wave_number_(2.0 * std::numbers::pi * grid.centre_hz / kSpeedOfLight),
      basis_(grid) {
  for (int i = -kDecaysBelow; i <= kDecaysAbove; ++i) {
    diffuse_.push_back(basis_.diffuse_covariance(kDiffuseDecay * std::exp2(i / kDecaysAnOctave)));
  }
}

std::vector<Value> ObservationModel::diffuse_covariance(double decay) const {
  const double octaves = std::log2(decay / kDiffuseDecay);
  const double position = std::clamp(
      kDecaysBelow + kDecaysAnOctave * octaves, 0.0, static_cast<double>(diffuse_.size() - 1));
  const auto below = std::min(static_cast<std::size_t>(position), diffuse_.size() - 2);
  const double share = position - static_cast<double>(below);
  std::vector<Value> result = diffuse_[below];
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] += share * (diffuse_[below + 1][i] - diffuse_[below][i]);
  }
  return result;
}

double ObservationModel::coherence(const Ray& ray,
                                   const Ray& first,
                                   const Place& place,
                                   const ModelError& error) const {
  const double surfaces = 2.0 * wave_number_ * error.plan_tolerance;
  double variance = surfaces * surfaces * ray.cos2_incidence;
  // Moving the device by x changes the length difference to the first ray by (e - e_first) x.
  const Vec3d change = ray.at_device - first.at_device;
  const double cell = wave_number_ * place.cell_size;
  variance += cell * cell * (change.x * change.x + change.y * change.y) / 12.0;
  const double layer = wave_number_ * place.cell_height;
  variance += layer * layer * change.z * change.z / 12.0;
  const double survey = wave_number_ * place.survey_sigma;
  variance += survey * survey * dot(change, change);
  return std::exp(-0.5 * variance);
}

ObservationModel::Parts ObservationModel::parts(const Ray& ray,
                                                const Ray& first,
                                                const Place& place,
                                                const ModelError& error) const {
  if (knowledge_ == PathKnowledge::kPower) {
    return {0.0, 1.0};
  }
  if (knowledge_ == PathKnowledge::kFull) {
    ModelError exact = error;
    exact.plan_tolerance = 0.0;
    const double known = coherence(ray, first, place, exact);
    return {known, 1.0 - known * known};
  }
  const double known = coherence(ray, first, place, error);
  return {known, 1.0 - known * known + error.strength * strength_variance(ray.reflections)};
}

ObservationModel::RayTerms ObservationModel::ray_terms(const Place& place,
                                                       const ModelError& error) const {
  const Ray& first = first_of(place.rays);
  RayTerms terms;
  terms.first_length = first.length;
  double power = 0.0;
  for (const Ray& ray : place.rays) {
    power += std::norm(ray.amplitude);
  }
  const double scale = 1.0 / std::sqrt(power * static_cast<double>(antennas_));
  std::vector<Value> tone(basis_.size());
  terms.parts.reserve(place.rays.size());
  terms.tone.reserve(place.rays.size() * tone.size());
  for (const Ray& ray : place.rays) {
    terms.parts.push_back(parts(ray, first, place, error));
    basis_.tone((ray.length - first.length) / kSpeedOfLight, tone);
    for (const Value& value : tone) {
      terms.tone.push_back(scale * ray.amplitude * value);
    }
  }
  return terms;
}

void ObservationModel::put_array(const Place& place,
                                 const RayTerms& terms,
                                 std::size_t p,
                                 std::span<Value> s) const {
  const Ray& ray = place.rays[p];
  const std::size_t q = basis_.size();
  for (std::size_t m = 0; m < antennas_; ++m) {
    const double length = norm(ray.length * ray.at_array - place.element_offset[m]);
    const Value phase = std::polar(1.0, -wave_number_ * (length - terms.first_length));
    for (std::size_t i = 0; i < q; ++i) {
      s[m * q + i] = phase * terms.tone[p * q + i];
    }
  }
}

std::size_t ObservationModel::obstructable(std::span<const Ray> rays) const {
  if (knowledge_ != PathKnowledge::kPartial || rays.size() < 2) {
    return rays.size();
  }
  return static_cast<std::size_t>(
      std::find_if(rays.begin(), rays.end(), [](const Ray& ray) { return ray.reflections == 0; }) -
      rays.begin());
}

double diffuse_share(const ModelError& error, double first_length) {
  return error.diffuse * std::pow(first_length / kDiffuseReference, error.diffuse_exponent);
}

// Adds `weight` times a place's second moment about its mean, and returns the mean.
PlaceMean ObservationModel::add_rays(const Place& place,
                                     const ModelError& error,
                                     double weight,
                                     PlaceMoments& moments) const {
  RAYLOC_CHECK(place.element_offset.size() == antennas_);
  const RayTerms terms = ray_terms(place, error);
  const auto size = static_cast<Index>(dimension());
  PlaceMean mean{Eigen::VectorXcd::Zero(size), {}};
  Eigen::MatrixXcd unknown(size, static_cast<Index>(place.rays.size()));
  const std::size_t obstructable = this->obstructable(place.rays);
  for (std::size_t p = 0; p < place.rays.size(); ++p) {
    auto s = unknown.col(static_cast<Index>(p));
    put_array(place, terms, p, {s.data(), dimension()});
    mean.all += terms.parts[p].known * s;
    if (p == obstructable) {
      mean.direct = terms.parts[p].known * s;
    }
    s *= std::sqrt(weight * terms.parts[p].unknown);
  }
  moments.add(unknown);
  moments.diffuse += weight * diffuse_share(error, terms.first_length);
  return mean;
}

PlaceModel ObservationModel::place(const Place& place, const ModelError& error) const {
  if (place.rays.empty()) {
    return {};
  }
  PlaceMoments moments(static_cast<Index>(dimension()));
  moments.mean = add_rays(place, error, 1.0, moments);
  return moments.factorised(antennas_, diffuse_covariance(error.diffuse_decay), error.noise);
}

PlaceModel ObservationModel::column(std::span<const WeightedPlace> heights,
                                    const ModelError& error) const {
  PlaceMoments moments(static_cast<Index>(dimension()));
  std::vector<PlaceMean> means;
  for (const WeightedPlace& one : heights) {
    if (one.place.rays.empty()) {
      return {};
    }
    means.push_back(add_rays(one.place, error, one.weight, moments));
  }
  moments.mean = {Eigen::VectorXcd::Zero(static_cast<Index>(dimension())), {}};
  for (std::size_t i = 0; i < means.size(); ++i) {
    moments.mean.all += heights[i].weight * means[i].all;
    if (means[i].direct.size() > 0) {
      if (moments.mean.direct.size() == 0) {
        moments.mean.direct = Eigen::VectorXcd::Zero(moments.mean.all.size());
      }
      moments.mean.direct += heights[i].weight * means[i].direct;
    }
  }
  for (std::size_t i = 0; i < means.size(); ++i) {
    moments.add(std::sqrt(heights[i].weight) * (means[i].all - moments.mean.all));
  }
  return moments.factorised(antennas_, diffuse_covariance(error.diffuse_decay), error.noise);
}

PlaceModel ObservationModel::place_of_burst(const Place& place,
                                            const ModelError& error,
                                            const ObservedArray& observed) const {
  PlaceModel model = this->place(place, with_noise(error, observed));
  model.noise = 0.0F;
  return model;
}

PlaceModel ObservationModel::null_model(const ModelError& error) const {
  PlaceMoments moments(static_cast<Index>(dimension()));
  moments.diffuse = 1.0;
  return moments.factorised(antennas_, diffuse_covariance(kDiffuseDecay), error.noise);
}

double ObservationModel::first_delay(std::span<const Value> h) const {
  const std::size_t tones = grid_.size();
  const auto [step, steps] = first_delay_search(grid_);
  std::vector<Value> rotated(h.begin(), h.end());
  std::vector<Value> turn(tones);
  for (std::size_t k = 0; k < tones; ++k) {
    turn[k] = std::polar(1.0, 2.0 * std::numbers::pi * grid_.offset_hz(k) * step);
  }
  double best_power = -1.0;
  double best = 0.0;
  for (std::size_t i = 0; i < steps; ++i) {
    double power = 0.0;
    for (std::size_t m = 0; m < antennas_; ++m) {
      Value sum;
      for (std::size_t k = 0; k < tones; ++k) {
        Value& v = rotated[m * tones + k];
        sum += v;
        v = Value(v.real() * turn[k].real() - v.imag() * turn[k].imag(),
                  v.real() * turn[k].imag() + v.imag() * turn[k].real());
      }
      power += std::norm(sum);
    }
    if (power > best_power) {
      best_power = power;
      best = step * static_cast<double>(i);
    }
  }
  return best;
}

ObservedArray ObservationModel::observe(std::span<const Value> h) const {
  const std::size_t tones = grid_.size();
  RAYLOC_CHECK(h.size() == antennas_ * tones);
  double power = 0.0;
  for (const Value& v : h) {
    power += std::norm(v);
  }
  ObservedArray observed(dimension());
  if (power <= 0.0) {
    return observed;
  }
  // Shifted to the first delay of the search, then by one step at a time.
  const double scale = 1.0 / std::sqrt(power);
  const double start = first_delay(h) - ObservedArray::kEarliest;
  std::vector<Value> moved(h.begin(), h.end());
  std::vector<Value> step(tones);
  for (std::size_t k = 0; k < tones; ++k) {
    const double w = 2.0 * std::numbers::pi * grid_.offset_hz(k);
    step[k] = std::polar(1.0, -w * ObservedArray::kDelayStep);
    const Value turn = std::polar(scale, w * start);
    for (std::size_t m = 0; m < antennas_; ++m) {
      moved[m * tones + k] *= turn;
    }
  }
  std::vector<Value> coordinates(basis_.size());
  for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
    double captured = 0.0;
    for (std::size_t m = 0; m < antennas_; ++m) {
      basis_.project({moved.data() + m * tones, tones}, coordinates);
      for (std::size_t i = 0; i < basis_.size(); ++i) {
        const Value v = coordinates[i];
        observed.set(m * basis_.size() + i, t, v);
        captured += std::norm(v);
      }
      for (std::size_t k = 0; k < tones; ++k) {
        Value& v = moved[m * tones + k];
        v = Value(v.real() * step[k].real() - v.imag() * step[k].imag(),
                  v.real() * step[k].imag() + v.imag() * step[k].real());
      }
    }
    observed.captured = std::max(observed.captured, captured);
  }
  return observed;
}

double ObservationModel::log_likelihood(const PlaceModel& place, const ObservedArray& observed) {
  return log_likelihood(place, observed, coarse(place, observed).windows);
}

double ObservationModel::log_likelihood(const PlaceModel& place,
                                        const ObservedArray& observed,
                                        std::uint8_t windows) {
  const bool is_weak = lacks_noise(place, observed);
  double best = std::numeric_limits<double>::lowest();
  for_windows(place, observed, windows, [&](std::size_t w, const LaneRow& values) {
    const auto at =
        static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
    if (is_weak) {
      best = std::max(best, log_likelihood_with_noise(place, observed, observed.windows[w], at));
      return;
    }
    auto peak = static_cast<double>(values[at]);
    if (at > 0 && at + 1 < values.size()) {
      // The vertex of the parabola through the best delay and its neighbours.
      const auto before = static_cast<double>(values[at - 1]);
      const auto after = static_cast<double>(values[at + 1]);
      const double slope = 0.5 * (after - before);
      const double curvature = after - 2.0 * peak + before;
      if (curvature < 0.0) {
        peak -= 0.5 * slope * slope / curvature;
      }
    }
    best = std::max(best, peak - place.log_determinant);
  });
  return best;
}

ObservationModel::Coarse ObservationModel::coarse(const PlaceModel& place,
                                                  const ObservedArray& observed) {
  const LaneRow values = better(place, observed.coarse);
  const auto top = std::max_element(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(top - values.begin());
  return {lacks_noise(place, observed)
              ? log_likelihood_with_noise(place, observed, observed.coarse, at)
              : static_cast<double>(*top) - place.log_determinant,
          ObservedArray::peak_windows(values)};
}

std::optional<double> ObservationModel::obstructed_log_odds(const PlaceModel& place,
                                                            const ObservedArray& observed) {
  if (place.mean.size() <= observed.coordinates()) {
    return std::nullopt;
  }
  float open = std::numeric_limits<float>::lowest();
  float obstructed = open;
  for (const ObservedArray::Block& block : observed.windows) {
    const Profile both = profile(place, block);
    open = std::max(open, *std::max_element(both.open.begin(), both.open.end()));
    obstructed =
        std::max(obstructed, *std::max_element(both.obstructed.begin(), both.obstructed.end()));
  }
  return static_cast<double>(obstructed) - static_cast<double>(open);
}

std::vector<Value> ObservationModel::expected(const Place& place, const ModelError& error) const {
  std::vector<Value> h(antennas_ * grid_.size());
  if (place.rays.empty()) {
    return h;
  }
  const Ray& first = first_of(place.rays);
  for (const Ray& ray : place.rays) {
    const Value amplitude = ray.amplitude * coherence(ray, first, place, error);
    for (std::size_t m = 0; m < antennas_; ++m) {
      const double length =
          norm(ray.length * ray.at_array - place.element_offset[m]) - first.length;
      // From tone to tone by complex rotation, which is far cheaper than a sine each.
      const double delay = length / kSpeedOfLight;
      const Value turn = std::polar(1.0, -2.0 * std::numbers::pi * grid_.spacing_hz * delay);
      Value v =
          amplitude * std::polar(1.0, -2.0 * std::numbers::pi * grid_.frequency_hz(0) * delay);
      for (std::size_t k = 0; k < grid_.size(); ++k) {
        for (int tone = k == 0 ? grid_.tone_index[0] : grid_.tone_index[k - 1];
             tone < grid_.tone_index[k];
             ++tone) {
          v = Value(v.real() * turn.real() - v.imag() * turn.imag(),
                    v.real() * turn.imag() + v.imag() * turn.real());
        }
        h[m * grid_.size() + k] += v;
      }
    }
  }
  return h;
}

}  // namespace rayloc
