#include "engine/chains/close_bursts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/chains/chain_belief.h"
#include "engine/chains/state_comparison.h"
#include "engine/localize/place_sample.h"
#include "engine/posterior/access_point_fusion.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr std::size_t kMaxKept = 48;     // a count, chosen: 30 kB per burst and access point
constexpr std::size_t kMinKept = 10;     // a count, chosen: as many as learning a state takes
constexpr std::size_t kRefineAfter = 4;  // a count, chosen: new bursts before factors are refined
constexpr std::size_t kSample = 64;      // a count of places, chosen
constexpr double kStale = 0.05;          // [rad], chosen: change after which places are drawn again
constexpr double kMaxTurn =
    0.25;  // [rad], chosen, per step: the drawn places delay the change or exaggerate it
constexpr double kMaxOutlierShare = 0.5;  // a probability, chosen: above it the burst is not used

// Log-likelihood of a burst with the accepted states of the chains.
double as_accepted(const ChainMoments& moments) {
  return moments.log_likelihood(std::vector<Value>(moments.chains, 1.0));
}

// Index of the first place of each run within one cell and layer; then the number of places.
std::vector<std::size_t> first_of_each_box(const std::vector<SampledPlace>& places) {
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 0 || places[i].cell != places[i - 1].cell || places[i].layer != places[i - 1].layer) {
      first.push_back(i);
    }
  }
  first.push_back(places.size());
  return first;
}

}  // namespace

void CloseBursts::add(const Localizer& localizer, const RoomObservation& observation) {
  if (observation.arrays.empty()) {
    return;
  }
  sample_again(localizer);
  Burst burst;
  burst.observation.arrays = observation.arrays;
  if (!sample(localizer, burst)) {
    return;
  }
  if (bursts_.size() == kMaxKept) {
    bursts_.pop_front();
  }
  bursts_.push_back(std::move(burst));
  ++unused_;
}

// Returns false if the burst contains no information on the place.
bool CloseBursts::sample(const Localizer& localizer, Burst& burst) const {
  const RoomObservation& observation = burst.observation;
  const Localizer::Evidence evidence = localizer.evidence(observation, Localizer::Scan::kPlaces);
  if (evidence.log_likelihood.empty() || evidence.outlier > kMaxOutlierShare) {
    return false;
  }
  const std::vector<SampledPlace> places = sample_places(localizer, observation, evidence, kSample);
  burst.log_weight.clear();
  burst.received.clear();
  burst.rotated = 0.0;
  for (const SampledPlace& place : places) {
    burst.log_weight.push_back(std::log(place.share));
  }
  const std::vector<std::size_t> boxes = first_of_each_box(places);
  for (const ArrayObservation& array : observation.arrays) {
    const std::vector<Value> undoing(array.map->antennas(), 1.0);
    std::vector<ChainMoments> moments(places.size());
    parallel_for(boxes.size() - 1, 1, [&](std::size_t box) {
      const SampledPlace& first = places[boxes[box]];
      const auto evaluator = array.map->evaluator_at(first.cell, first.layer, array.observed);
      for (std::size_t i = boxes[box]; i < boxes[box + 1]; ++i) {
        moments[i] =
            chain_moments(evaluator->model_at(places[i].moved), array.observed.array, undoing);
      }
    });
    for (std::size_t i = 0; i < places.size(); ++i) {
      burst.log_weight[i] -= likelihood_exponent_ * as_accepted(moments[i]);
    }
    burst.received.emplace(array.map->number(), std::move(moments));
  }
  return !places.empty();
}

// Samples again the burst for which the states have changed most.
void CloseBursts::sample_again(const Localizer& localizer) {
  const auto most =
      std::max_element(bursts_.begin(), bursts_.end(), [](const auto& a, const auto& b) {
        return a.rotated < b.rotated;
      });
  if (most != bursts_.end() && most->rotated > kStale && !sample(localizer, *most)) {
    bursts_.erase(most);
  }
}

void CloseBursts::accept(std::size_t access_point, std::span<const Value> factor) {
  const std::vector<Value> undoing = inverses({factor.begin(), factor.end()});
  const double rotated =
      distance({factor.begin(), factor.end()}, std::vector<Value>(factor.size(), 1.0));
  for (Burst& burst : bursts_) {
    const auto found = burst.received.find(access_point);
    if (found == burst.received.end()) {
      continue;
    }
    burst.rotated += rotated;
    for (ChainMoments& moments : found->second) {
      moments = moments.multiplied(undoing);
    }
    for (ArrayObservation& array : burst.observation.arrays) {
      if (array.map->number() == access_point) {
        multiply(undoing, array.h);
        array.observed = array.map->observe(array.h, array.observed.array.noise);
      }
    }
  }
}

// The weights of its places include the evidence of the other access points.
PlacedBurst CloseBursts::placed(const Burst& burst, std::size_t access_point) const {
  PlacedBurst result;
  result.places = burst.received.at(access_point);
  result.log_weight = burst.log_weight;
  double sum = 0.0;
  for (std::size_t i = 0; i < result.places.size(); ++i) {
    for (const auto& [number, moments] : burst.received) {
      if (number != access_point) {
        result.log_weight[i] += likelihood_exponent_ * as_accepted(moments[i]);
      }
    }
    const double value =
        result.log_weight[i] + likelihood_exponent_ * as_accepted(result.places[i]);
    sum = i == 0 ? value : log_add(sum, value);
  }
  result.floor = sum - ChainBelief::kMaxOfBurst;
  return result;
}

void CloseBursts::clear() {
  bursts_.clear();
  unused_ = 0;
}

bool CloseBursts::is_due() {
  if (unused_ < kRefineAfter) {
    return false;
  }
  unused_ = 0;
  return true;
}

bool CloseBursts::includes(std::size_t access_point) const {
  const auto count = std::count_if(bursts_.begin(), bursts_.end(), [&](const Burst& burst) {
    return burst.received.contains(access_point);
  });
  return static_cast<std::size_t>(count) >= kMinKept;
}

ChainFactors CloseBursts::refined(std::size_t access_point) const {
  std::vector<PlacedBurst> bursts;
  for (const Burst& burst : bursts_) {
    if (burst.received.contains(access_point)) {
      bursts.push_back(placed(burst, access_point));
    }
  }
  const std::size_t chains = bursts.front().places.front().chains;
  ChainFactors refined =
      refine_chains(bursts, std::vector<Value>(chains, 1.0), likelihood_exponent_);
  const double rotated = distance(refined.factor, std::vector<Value>(chains, 1.0));
  if (rotated > kMaxTurn) {
    for (Value& factor : refined.factor) {
      factor = std::polar(std::abs(factor), std::arg(factor) * kMaxTurn / rotated);
    }
  }
  return refined;
}

}  // namespace rayloc
