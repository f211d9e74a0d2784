#include "engine/calibrate/person_certainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include "engine/base/check.h"
#include "engine/localize/people.h"

namespace rayloc {
namespace {

constexpr std::size_t kParts = 3;
constexpr std::array<double, 8> kTempers = {0.05, 0.1, 0.15, 0.25, 0.35, 0.5, 0.7, 1.0};
// The truth counts as found within about this much: cells and known places are as coarse [m].
constexpr double kKernel = 0.05;
// Spots from which the most that a second person explains is known, and the least that it is said
// to be.
constexpr std::size_t kLeastSpots = 20;
constexpr double kLeastGain = 20.0;

// Probability density about the truth, against that of knowing nothing.
double score(const StandingRoom& standing, const PersonMap& map, const TargetPosition& truth) {
  double top = -std::numeric_limits<double>::infinity();
  for (const double value : map.log_likelihood) {
    top = std::max(top, value);
  }
  double mass = 0.0;
  double near = 0.0;
  double blank = 0.0;
  double free = 0.0;
  for (std::size_t cell = 0; cell < map.log_likelihood.size(); ++cell) {
    if (standing.free[cell] == 0) {
      continue;
    }
    const Vec3d centre = standing.grid.centre(cell);
    const double x = (centre.x - truth.x) / kKernel;
    const double y = (centre.y - truth.y) / kKernel;
    const double kernel = std::exp(-0.5 * (x * x + y * y));
    const double weight = std::exp(map.log_likelihood[cell] - top);
    mass += weight;
    near += weight * kernel;
    free += 1.0;
    blank += kernel;
  }
  // A place where nobody can stand, or where the map has nothing, is as bad as a thousandth.
  constexpr double kLeast = 1e-3;
  return std::log(std::max(near / mass, kLeast * blank / free) * free);
}

// The smallest exponent that is not worse than the best by more than the standard error of their
// difference: tens of spots cannot tell more, and stating too much is worse than too little.
double chosen(const std::array<std::vector<double>, kTempers.size()>& scores) {
  const auto sum = [](const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
  };
  std::size_t best = 0;
  for (std::size_t t = 1; t < scores.size(); ++t) {
    best = sum(scores[t]) > sum(scores[best]) ? t : best;
  }
  const auto count = static_cast<double>(scores[best].size());
  for (std::size_t t = 0; t < best; ++t) {
    const double mean = (sum(scores[best]) - sum(scores[t])) / count;
    double variance = 0.0;
    for (std::size_t s = 0; s < scores[t].size(); ++s) {
      const double off = scores[best][s] - scores[t][s] - mean;
      variance += off * off / (count * (count - 1.0));
    }
    if (mean <= std::sqrt(variance)) {
      return kTempers[t];
    }
  }
  return kTempers[best];
}

// What the best second person explains; 0 where none is looked for.
double second_gain(const PersonLocalizer& localizer, const PersonHearing& hearing) {
  if (hearing.arrays.empty()) {
    return 0.0;
  }
  const double temper = localizer.reference().person.temper;
  const auto pair = best_pair(localizer, hearing, temper, localizer.map(hearing, temper));
  return pair ? pair->gain : 0.0;
}

}  // namespace

Expected<PersonCertainty> fit_person_certainty(const RoomModel& room,
                                               const PersonFit& fit,
                                               std::span<const PersonSpot> spots,
                                               std::span<const std::vector<CsiFrame>> frames,
                                               const PersonFitOptions& options) {
  RAYLOC_CHECK(spots.size() == frames.size());
  const auto shared = std::make_shared<const RoomModel>(room);
  PersonFitOptions same_body = options;
  same_body.radius_steps.clear();
  std::array<std::vector<double>, kTempers.size()> scores;  // of each exponent, by spot
  double gain = kLeastGain;
  for (std::size_t part = 0; part < kParts; ++part) {
    std::vector<PersonSpot> others;
    for (std::size_t s = 0; s < spots.size(); ++s) {
      if (s % kParts != part) {
        others.push_back(spots[s]);
      }
    }
    auto fitted = fit_person(room, fit.reference, others, same_body);
    if (!fitted) {
      return tl::make_unexpected(std::move(fitted.error()));
    }
    const auto localizer = PersonLocalizer::create(shared, std::move(fitted->reference), {});
    if (!localizer) {
      return tl::make_unexpected(localizer.error());
    }
    for (std::size_t s = part; s < spots.size(); s += kParts) {
      const PersonHearing hearing = localizer->hear(frames[s]);
      for (std::size_t t = 0; t < kTempers.size() && !hearing.arrays.empty(); ++t) {
        const PersonMap map = localizer->map(hearing, kTempers[t]);
        scores[t].push_back(score(localizer->standing_room(), map, spots[s].place));
      }
      gain = std::max(gain, second_gain(*localizer, hearing));
    }
  }
  PersonCertainty certainty{chosen(scores), std::nullopt};
  if (scores.front().size() >= kLeastSpots) {
    certainty.second_person = gain;
  }
  return certainty;
}

}  // namespace rayloc
