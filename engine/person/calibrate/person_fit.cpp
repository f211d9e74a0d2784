#include "engine/person/calibrate/person_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/person/calibrate/person_geometry.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kPatchSide = 0.06;   // [m], about a known place
constexpr std::size_t kSamples = 11;  // a count along a side, chosen: 6 mm apart over kPatchSide
constexpr int kFitPhases = 24;        // a count, chosen: 15 degrees apart
// Ratios to a body's wave, chosen: 2 to 4 dB apart.
constexpr std::array<double, 6> kFitLevels = {0.4, 0.6, 0.8, 1.0, 1.25, 1.6};
// The finer scan about the best of them: steps of the logarithm, and their count to each side.
constexpr double kFineLevel = 0.06;
constexpr int kFineSteps = 2;
// Ratios of a ray's power, chosen: 3 dB apart.
constexpr std::array<double, 9> kVariances = {
    0.004, 0.008, 0.015, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0};
// The same, for a path.
constexpr std::array<double, 8> kPathVariances = {0.0, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0, 2.0};
// Ratios of the traced power, chosen: 3 dB apart.
constexpr std::array<double, 9> kDiffuseScan = {
    0.004, 0.008, 0.015, 0.03, 0.06, 0.12, 0.25, 0.5, 1.0};
// Ratios of all the power, chosen: 3 to 4 dB apart.
constexpr std::array<double, 6> kNoiseScan = {1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 4e-3};
// [m], chosen: the phase of a wave that comes straight back changes by 0.6 to 6.5 rad.
constexpr std::array<double, 2> kFronts = {0.0, 0.03};
constexpr int kErrorRounds = 4;         // a count, chosen: over the errors, one after the other
constexpr double kFitLevelSigma = 0.3;  // of the logarithm of |a|

struct ReceivedPoint {
  std::size_t point = 0;
  ScatteredPatch patch;
  PersonLikelihood::Observed observed;
};

// Observations of all points by one link, with one body.
struct FitLink {
  PersonLikelihood likelihood;
  std::vector<ReceivedPoint> received;
};

class PersonFitter {
 public:
  PersonFitter(const RoomModel& room,
               const PersonReference& reference,
               std::span<const PersonPoint> points,
               const PersonFitOptions& options)
      : room_(room), reference_(reference), points_(points), options_(options) {
    const PatchPlan plan{0.0, 0.0, kPatchSide, kSamples};
    const double scale = -0.5 / (options.place_sigma * options.place_sigma);
    for (std::size_t i = 0; i < kSamples; ++i) {
      for (std::size_t j = 0; j < kSamples; ++j) {
        prior_.push_back(scale * (plan.at(i) * plan.at(i) + plan.at(j) * plan.at(j)));
      }
    }
  }

  Expected<std::vector<FitLink>> listen(const PersonModel& person) const;
  // Sum over the points of the log-likelihood of their link alone.
  double of_link(const FitLink& link, Value scale, const PersonModel& model) const;
  // All links of a point together.
  double of_all(const std::vector<FitLink>& links,
                const std::vector<Value>& scales,
                const PersonModel& model) const;
  Value best_scale(const FitLink& link, const PersonModel& model) const;
  PersonModel best_errors(const std::vector<FitLink>& links,
                          const std::vector<Value>& scales,
                          PersonModel model) const;

 private:
  std::vector<double> samples(const FitLink& link,
                              const ReceivedPoint& received,
                              Value scale,
                              const PersonModel& model,
                              double no_person) const;
  double marginal(std::span<const double> samples) const;

  const RoomModel& room_;
  const PersonReference& reference_;
  std::span<const PersonPoint> points_;
  const PersonFitOptions& options_;
  std::vector<double> prior_;  // log, of each sample place about a known one
};

Expected<std::vector<FitLink>> PersonFitter::listen(const PersonModel& person) const {
  const PatchPlan plan{0.0, 0.0, kPatchSide, kSamples, options_.place_sigma};
  std::vector<FitLink> links;
  for (std::size_t l = 0; l < reference_.links.size(); ++l) {
    const PersonLink& link = reference_.links[l];
    const RoomAccessPoint& ap = room_.access_points[link.access_point];
    const auto scattering = PersonScattering::create(
        room_, link.access_point, reference_.transmitter, person.body, options_.depth);
    RAYLOC_TRY(scattering);
    FitLink fit{PersonLikelihood(room_.grid,
                                 ap.rx_chains.size(),
                                 link,
                                 norm(ap.array.pose.position - reference_.transmitter.position)),
                {}};
    std::vector<std::optional<ReceivedPoint>> received(points_.size());
    parallel_for(points_.size(), 1, [&](std::size_t s) {
      const auto rays = points_[s].h[l].empty() ? std::nullopt : scattering->at(points_[s].place);
      if (rays) {
        received[s] = ReceivedPoint{s,
                                    fit.likelihood.patch(*rays, plan, person.front_offset_sigma),
                                    fit.likelihood.observe(points_[s].h[l])};
      }
    });
    for (auto& one : received) {
      if (one) {
        fit.received.push_back(*std::move(one));
      }
    }
    links.push_back(std::move(fit));
  }
  return links;
}

std::vector<double> PersonFitter::samples(const FitLink& link,
                                          const ReceivedPoint& received,
                                          Value scale,
                                          const PersonModel& model,
                                          double no_person) const {
  std::vector<double> values(prior_.size());
  link.likelihood.log_likelihood(
      link.likelihood.place(received.patch, scale, model), received.observed, {}, values);
  for (double& value : values) {
    value -= no_person;
  }
  return values;
}

double PersonFitter::marginal(std::span<const double> samples) const {
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    top = std::max(top, samples[i] + prior_[i]);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    sum += std::exp(samples[i] + prior_[i] - top);
  }
  return top + std::log(sum / static_cast<double>(samples.size()));
}

double PersonFitter::of_link(const FitLink& link, Value scale, const PersonModel& model) const {
  std::vector<double> sums(link.received.size());
  parallel_for(sums.size(), 2, [&](std::size_t i) {
    sums[i] = marginal(samples(link, link.received[i], scale, model, 0.0));
  });
  double total = 0.0;
  for (const double sum : sums) {
    total += sum;
  }
  return total;
}

double PersonFitter::of_all(const std::vector<FitLink>& links,
                            const std::vector<Value>& scales,
                            const PersonModel& model) const {
  std::vector<std::vector<double>> sums(points_.size(), std::vector<double>(prior_.size()));
  for (std::size_t l = 0; l < links.size(); ++l) {
    parallel_for(links[l].received.size(), 2, [&](std::size_t i) {
      const ReceivedPoint& received = links[l].received[i];
      const auto values = samples(links[l], received, scales[l], model, 0.0);
      for (std::size_t p = 0; p < values.size(); ++p) {
        sums[received.point][p] += values[p];
      }
    });
  }
  double total = 0.0;
  for (const auto& sum : sums) {
    total += marginal(sum);
  }
  return total;
}

// A scan over phase and amplitude, then a finer one about the best.
Value PersonFitter::best_scale(const FitLink& link, const PersonModel& model) const {
  Value best = 1.0;
  double most = -std::numeric_limits<double>::infinity();
  const auto attempt = [&](Value scale) {
    const double level = std::log(std::abs(scale)) / kFitLevelSigma;
    const double value = of_link(link, scale, model) - 0.5 * level * level;
    if (value > most) {
      most = value;
      best = scale;
    }
  };
  for (const double level : kFitLevels) {
    for (int i = 0; i < kFitPhases; ++i) {
      attempt(std::polar(level, 2.0 * std::numbers::pi * i / kFitPhases));
    }
  }
  const Value rough = best;
  for (int i = -kFineSteps; i <= kFineSteps; ++i) {
    for (int j = -2; j <= 2; ++j) {
      attempt(rough *
              std::polar(std::exp(kFineLevel * i), 2.0 * std::numbers::pi * j / (5 * kFitPhases)));
    }
  }
  return best;
}

// Fits the errors one after the other until none improves.
PersonModel PersonFitter::best_errors(const std::vector<FitLink>& links,
                                      const std::vector<Value>& scales,
                                      PersonModel model) const {
  double most = of_all(links, scales, model);
  bool better = false;
  const auto scan = [&](double PersonModel::*error, std::span<const double> values) {
    for (const double value : values) {
      PersonModel tried = model;
      tried.*error = value;
      if (const double there = of_all(links, scales, tried); there > most) {
        most = there;
        model = tried;
        better = true;
      }
    }
  };
  for (int round = 0; round < kErrorRounds; ++round) {
    better = false;
    scan(&PersonModel::path_variance, kPathVariances);
    scan(&PersonModel::strength_variance, kVariances);
    scan(&PersonModel::diffuse, kDiffuseScan);
    scan(&PersonModel::noise, kNoiseScan);
    if (!better) {
      break;
    }
  }
  return model;
}

// The fit with a known body.
Expected<PersonFit> fit_body(const RoomModel& room,
                             const PersonReference& reference,
                             std::span<const PersonPoint> points,
                             const PersonFitOptions& options) {
  PersonFit fit{reference, 0.0, 0};
  PersonModel& person = fit.reference.person;
  const PersonFitter fitter(room, fit.reference, points, options);
  const auto links = fitter.listen(person);
  RAYLOC_TRY(links);
  std::vector<Value> scales;
  for (const FitLink& link : *links) {
    fit.points = std::max(fit.points, link.received.size());
    scales.push_back(fitter.best_scale(link, person));
  }
  if (fit.points < kMinPersonPoints) {
    return bad_input("people were observed at " + std::to_string(fit.points) + " places; " +
                     std::to_string(kMinPersonPoints) + " are needed to fit the model of a person");
  }
  person = fitter.best_errors(*links, scales, person);
  for (std::size_t l = 0; l < scales.size(); ++l) {
    scales[l] = fitter.best_scale((*links)[l], person);
    fit.reference.links[l].scale = scales[l];
  }
  fit.log_likelihood = fitter.of_all(*links, scales, person);
  return fit;
}

}  // namespace

bool is_scale_at_limit(std::complex<double> scale) {
  const double margin = std::exp(kFineLevel * (kFineSteps - 0.5));
  const double level = std::abs(scale);
  return level < kFitLevels.front() / margin || level > kFitLevels.back() * margin;
}

Expected<PersonFit> fit_person(const RoomModel& room,
                               const PersonReference& reference,
                               std::span<const PersonPoint> points,
                               const PersonFitOptions& options) {
  if (options.radius_steps.empty()) {
    return fit_body(room, reference, points, options);
  }
  const auto geometry = fit_person_geometry(room, reference, points, options);
  RAYLOC_TRY(geometry);
  PersonReference tried = reference;
  tried.person.body.semi_axes = {geometry->radius, geometry->radius};
  tried.transmitter.position = reference.transmitter.position + geometry->shift;
  std::optional<PersonFit> best;
  for (const double front : kFronts) {
    tried.person.front_offset_sigma = front;
    auto fit = fit_body(room, tried, points, options);
    if (!fit) {
      return fit;
    }
    if (!best || fit->log_likelihood > best->log_likelihood) {
      best = *std::move(fit);
    }
  }
  return *std::move(best);
}

}  // namespace rayloc
