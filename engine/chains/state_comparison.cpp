#include "engine/chains/state_comparison.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/chains/chain_belief.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kPlaceMargin = 7.0;       // [nat], tempered: lower places have no weight
constexpr double kKnownPlaceSigma = 0.02;  // [m], per axis: a surveyed place

ChainFactors refined_from(const AccessPointMap& map,
                          std::span<const RememberedBurst> received,
                          const std::vector<Value>& start,
                          double likelihood_exponent) {
  const std::vector<Value> undoing = inverses(start);
  std::vector<PlacedBurst> bursts(received.size());
  parallel_for(bursts.size(), 1, [&](std::size_t b) {
    const RememberedBurst& one = received[b];
    std::vector<double> phase;
    for (std::size_t m = 0; m < start.size(); ++m) {
      phase.push_back(std::arg(start[m] * one.since[m] / (start[0] * one.since[0])));
    }
    const ObservedBurst observed = map.observe(one.h, one.noise);
    bursts[b].floor = one.floor;
    if (one.known_place != nullptr) {
      bursts[b].places.push_back(chain_moments(*one.known_place, observed.array, undoing));
      bursts[b].log_weight.push_back(0.0);
      return;
    }
    std::vector<ChainMoments> places;
    std::vector<double> value;
    std::vector<double> weight;
    for (const std::size_t cell : one.evidence.cells_near(phase)) {
      if (map.is_reachable(cell)) {
        places.push_back(chain_moments(map.model(cell), observed.array, undoing));
        weight.push_back(static_cast<double>(one.log_weight[cell]));
        value.push_back(likelihood_exponent * places.back().log_likelihood(undoing) +
                        weight.back());
      }
    }
    const auto top = std::max_element(value.begin(), value.end());
    const double least = top == value.end() ? 0.0 : *top - kPlaceMargin;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (value[i] > least) {
        bursts[b].places.push_back(places[i]);
        bursts[b].log_weight.push_back(weight[i]);
      }
    }
  });
  return refine_chains(bursts, start, likelihood_exponent);
}

}  // namespace

std::shared_ptr<const PlaceModel> known_place_model(const AccessPointMap& map, const Vec3d& place) {
  return std::make_shared<const PlaceModel>(map.model_of(map.rays_to(place), kKnownPlaceSigma));
}

double burst_floor(const AccessPointMap& map,
                   const RememberedBurst& burst,
                   double likelihood_exponent) {
  const std::vector<double>& log_evidence = burst.evidence.log_evidence;
  return *std::max_element(log_evidence.begin(), log_evidence.end()) +
         likelihood_exponent * map.null_model(map.observe(burst.h, burst.noise)) -
         ChainBelief::kMaxOfBurst;
}

// [rad], maximum phase difference over the chains.
double distance(const std::vector<Value>& a, const std::vector<Value>& b) {
  double most = 0.0;
  for (std::size_t m = 1; m < a.size(); ++m) {
    most = std::max(most, std::abs(std::arg(a[m] / a[0] * std::conj(b[m] / b[0]))));
  }
  return most;
}

std::vector<Value> inverses(const std::vector<Value>& factors) {
  std::vector<Value> result;
  result.reserve(factors.size());
  for (const Value& factor : factors) {
    result.push_back(1.0 / factor);
  }
  return result;
}

void multiply(const std::vector<Value>& factors, std::vector<Value>& h) {
  const std::size_t tones = h.size() / factors.size();
  for (std::size_t j = 0; j < h.size(); ++j) {
    h[j] *= factors[j / tones];
  }
}

ObservedBurst without_gain(const AccessPointMap& map,
                           std::vector<Value> h,
                           const std::vector<Value>& gain,
                           double noise) {
  multiply(inverses(gain), h);
  return map.observe(h, noise);
}

std::vector<ChainFactors> compare_states(const AccessPointMap& map,
                                         std::span<const RememberedBurst> received,
                                         std::span<const std::vector<Value>> starts,
                                         double likelihood_exponent) {
  std::vector<ChainFactors> all;
  for (const std::vector<Value>& start : starts) {
    all.push_back(refined_from(map, received, start, likelihood_exponent));
  }
  std::stable_sort(all.begin(), all.end(), [](const ChainFactors& a, const ChainFactors& b) {
    return a.log_evidence > b.log_evidence;
  });
  std::vector<ChainFactors> different;
  for (ChainFactors& one : all) {
    if (std::none_of(different.begin(), different.end(), [&](const ChainFactors& other) {
          return distance(one.factor, other.factor) < kSameState;
        })) {
      different.push_back(std::move(one));
    }
  }
  return different;
}

}  // namespace rayloc
