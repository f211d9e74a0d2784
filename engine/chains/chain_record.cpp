#include "engine/chains/chain_record.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "engine/chains/chain_evidence.h"
#include "engine/chains/chain_memory.h"
#include "engine/localize/access_point_map.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

ChainRecord::Burst record_burst(const RememberedBurst& burst) {
  ChainRecord::Burst record{burst.h, burst.time, burst.noise, burst.gain, {}, {}};
  if (burst.known_place != nullptr) {
    record.place = burst.place;
  } else if (std::any_of(burst.log_weight.begin(), burst.log_weight.end(), [&](float one) {
               return one != burst.log_weight.front();
             })) {
    record.log_weight = burst.log_weight;
  }
  return record;
}

// ln of the probability of each cell; the probabilities sum to 1.
std::vector<double> weights_in(const AccessPointMap& map, const ChainRecord::Burst& burst) {
  const auto cells = static_cast<double>(map.cells());
  if (burst.log_weight.size() != map.cells()) {
    return std::vector<double>(map.cells(), -std::log(cells));
  }
  std::vector<double> weights(burst.log_weight.begin(), burst.log_weight.end());
  double sum = 0.0;
  for (const double one : weights) {
    sum += std::exp(one);
  }
  for (double& one : weights) {
    one -= std::log(sum);
  }
  return weights;
}

// Sets the evidence and the data that belong to it; false for a place that no ray reaches.
bool evaluate(const AccessPointMap& map,
              const ChainRecord::Burst& burst,
              const RotationGrid& grid,
              double likelihood_exponent,
              RememberedBurst& result) {
  const std::vector<Value> gain(burst.gain.begin(), burst.gain.end());
  const ObservedBurst observed = without_gain(map, burst.h, gain, burst.noise);
  if (!burst.place) {
    const std::vector<double> log_weight = weights_in(map, burst);
    result.evidence = turn_evidence(map, observed, grid, likelihood_exponent, log_weight);
    result.log_weight.assign(log_weight.begin(), log_weight.end());
    return true;
  }
  result.known_place = known_place_model(map, *burst.place);
  if (result.known_place->reachable) {
    result.evidence = turn_evidence_at(*result.known_place,
                                       observed.array,
                                       grid,
                                       likelihood_exponent,
                                       map.null_model(map.observe(burst.h, burst.noise)));
  }
  return result.known_place->reachable;
}

}  // namespace

std::optional<ChainRecord> record_of(const ChainMemory& ap) {
  if (ap.state.knowledge != ChainKnowledge::kLearning ||
      (ap.waiting == nullptr && ap.received.empty())) {
    return std::nullopt;
  }
  ChainRecord record;
  if (ap.waiting != nullptr) {
    record = *ap.waiting;
    const auto first = record.received.begin();
    const std::size_t kept = std::min(ap.unevaluated, ChainMemory::kMost - ap.received.size());
    record.received.erase(first + static_cast<std::ptrdiff_t>(ap.unevaluated),
                          record.received.end());
    record.received.erase(first, first + static_cast<std::ptrdiff_t>(ap.unevaluated - kept));
  }
  for (const RememberedBurst& burst : ap.received) {
    record.received.push_back(record_burst(burst));
  }
  record.belief = ap.belief.probability();
  record.gain.clear();
  for (const Value& one : ap.gain) {
    record.gain.push_back(std::abs(one));
  }
  record.favourite = ap.favourite;
  record.unrefined = ap.unrefined;
  record.bursts = ap.state.bursts;
  record.bursts_needed = ap.state.bursts_needed;
  record.lead = ap.state.evidence;
  record.phase_sigma = ap.state.phase_sigma;
  return record;
}

void resume(ChainMemory& ap) {
  ap.waiting = std::exchange(ap.state.record, nullptr);
  ap.unevaluated = ap.waiting == nullptr ? 0 : ap.waiting->received.size();
  if (ap.waiting == nullptr) {
    return;
  }
  const ChainRecord& record = *ap.waiting;
  ap.belief.resume(record.belief);
  ap.gain.assign(record.gain.begin(), record.gain.end());
  ap.favourite = record.favourite;
  ap.unrefined = record.unrefined;
  ap.state.bursts = record.bursts;
  ap.state.bursts_needed = record.bursts_needed;
  ap.state.evidence = record.lead;
  ap.state.phase_sigma = record.phase_sigma;
}

void evaluate_waiting(const AccessPointMap& map, double likelihood_exponent, ChainMemory& ap) {
  if (ap.waiting == nullptr) {
    return;
  }
  const std::size_t end = ap.unevaluated - std::min(ap.unevaluated, kEvaluatedAtOnce);
  while (ap.unevaluated > end && ap.received.size() < ChainMemory::kMost) {
    const ChainRecord::Burst& burst = ap.waiting->received[--ap.unevaluated];
    RememberedBurst result;
    if (!evaluate(map, burst, ap.belief.grid(), likelihood_exponent, result)) {
      continue;
    }
    result.h = burst.h;
    result.time = burst.time;
    result.noise = burst.noise;
    result.gain = burst.gain;
    result.place = burst.place.value_or(Vec3d());
    result.floor = burst_floor(map, result, likelihood_exponent);
    result.since.assign(burst.gain.size(), 1.0);
    ap.received.insert(ap.received.begin(), std::move(result));
  }
  if (ap.unevaluated == 0 || ap.received.size() == ChainMemory::kMost) {
    ap.waiting.reset();
    ap.unevaluated = 0;
  }
}

}  // namespace rayloc
