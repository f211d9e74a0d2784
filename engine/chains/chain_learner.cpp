#include "engine/chains/chain_learner.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "engine/chains/cell_belief.h"
#include "engine/chains/chain_evidence.h"
#include "engine/chains/chain_frames.h"
#include "engine/chains/chain_record.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kRotatedAtStart = 0.1;      // a probability: the age of the calibration is unknown
constexpr double kRotatedAfterCycle = 0.98;  // a probability: each chip starts in a new state
constexpr double kUncertain = 0.2;  // probability of the accepted state; below: states are compared
constexpr double kRefuted = 0.01;   // the same; below: only a clear lead keeps the state
constexpr double kShaken = 0.9;     // the same; below: no refinement
constexpr double kSuspected = 0.5;  // the same; below: short evaluation period
constexpr double kWithdrawnLead = 5.0;     // [nat], required lead of another state
constexpr double kUnsuspectedLead = 12.0;  // the same, while the belief indicates no change
constexpr double kOthersWrong = 0.1;       // least probability that other access points are wrong
constexpr double kMinEvidence = 3.0;       // [nat], of a burst that the room explains in a state
// Counts of bursts, chosen.
constexpr std::size_t kCompareAfter = 3;       // new bursts before states are compared again
constexpr std::size_t kRefineAfterBursts = 8;  // new bursts before the learned state is refined
constexpr std::size_t kMaxNeeded = 200;        // largest number stated
constexpr std::size_t kModes = 6;              // a count of states to compare, chosen
// [s], chosen: between evaluations.
constexpr auto kLearningPeriod = std::chrono::milliseconds(250);
constexpr auto kRefiningPeriod = std::chrono::milliseconds(500);  // [s], chosen
constexpr auto kUnsettledPeriod = std::chrono::seconds(1);        // [s], chosen
constexpr auto kRecentSilence = std::chrono::minutes(1);          // chosen: as while learning
constexpr auto kSettledPeriod = std::chrono::seconds(5);          // [s], chosen

// With a dead chain left out, the states are different ones.
bool has_all_antennas(const ArrayObservation& received) {
  return received.map->antennas() == received.map->access_point().rx_chains.size();
}

// The burst with the amplitudes of the best state removed.
ObservedBurst gain_undone(const ArrayObservation& received, const ChainMemory& ap) {
  return without_gain(*received.map, received.h, ap.gain, received.observed.array.noise);
}

// The remembered bursts with which states are compared now; none while that has to wait.
std::span<const RememberedBurst> bursts_to_compare(Timestamp time, ChainMemory& ap) {
  if (ap.state.knowledge == ChainKnowledge::kLearning) {
    return ap.received;
  }
  if (ap.belief.as_accepted() <= kUncertain) {
    ap.forget_until_sure();
    return ap.bursts_since_silence();
  }
  const bool is_sure = ap.belief.as_accepted() > ChainMemory::kSure;
  if (is_sure) {
    ap.last_sure = time;
    ap.end_silences();
  }
  const bool is_learned = ap.state.knowledge == ChainKnowledge::kLearned;
  // Changed amplitudes hide a change from the belief; the comparison detects it.
  if (is_sure && !is_learned) {
    return {};
  }
  // Bursts from before a change would confirm the earlier state.
  const std::span<const RememberedBurst> since = ap.bursts_since_silence();
  if (!ap.silences.empty()) {
    return since.size() < kChainBurstsNeeded ? std::span<const RememberedBurst>() : since;
  }
  const bool is_shaken = is_learned && ap.belief.as_accepted() < kShaken;
  return is_shaken || ap.unrefined < kRefineAfterBursts ? std::span<const RememberedBurst>()
                                                        : since;
}

}  // namespace

ChainLearner::ChainLearner(std::shared_ptr<const Localizer> localizer)
    : localizer_(std::move(localizer)),
      aligner_(localizer_->room().grid),
      close_(localizer_->room().likelihood_exponent) {
  begin();
}
ChainLearner::~ChainLearner() = default;

bool ChainLearner::learns_from(LikelihoodKind kind) {
  return kind == LikelihoodKind::kPartial || kind == LikelihoodKind::kCoherent ||
         kind == LikelihoodKind::kPathCovariance;
}

// Frames of unknown chains have no weight from the first frame on.
void ChainLearner::begin() {
  for (const auto& [access_point, state] : restored_) {
    of(access_point);
  }
  const std::vector<RoomAccessPoint>& access_points = localizer_->room().access_points;
  for (std::size_t a = 0; a < access_points.size(); ++a) {
    const std::size_t chains = access_points[a].rx_chains.size();
    if (!access_points[a].are_chains_known && chains > 1 && chains <= kMaxChains) {
      of(a);
    }
  }
}

ChainMemory& ChainLearner::of(std::size_t access_point) {
  const auto found = aps_.find(access_point);
  if (found != aps_.end()) {
    return found->second;
  }
  ChainMemory ap(localizer_->room().access_points[access_point].rx_chains.size(), kRotatedAtStart);
  ap.state.access_point = access_point;
  ChainMemory& kept = aps_.emplace(access_point, std::move(ap)).first->second;
  ++changes_;
  if (const auto before = restored_.find(access_point); before != restored_.end()) {
    adopt(before->second);
  } else if (!localizer_->room().access_points[access_point].are_chains_known) {
    kept.belief.suspect(kRotatedAfterCycle);
    kept.set_knowledge(ChainKnowledge::kLearning, {});
  }
  return kept;
}

bool ChainLearner::is_due(std::size_t access_point,
                          Timestamp time,
                          Timestamp ChainMemory::*last) const {
  const auto found = aps_.find(access_point);
  if (found == aps_.end()) {
    return true;
  }
  const ChainMemory& ap = found->second;
  Duration period = kSettledPeriod;
  const bool is_recent = !ap.silences.empty() && time - ap.silences.back().end < kRecentSilence;
  if (ap.state.knowledge == ChainKnowledge::kLearning || is_recent ||
      ap.belief.as_accepted() < kSuspected) {
    period = kLearningPeriod;
  } else if (!ap.is_settled()) {
    period = ap.state.knowledge == ChainKnowledge::kLearned ? Duration(kRefiningPeriod)
                                                            : Duration(kUnsettledPeriod);
  }
  return time - ap.*last >= period;
}

// The access points for which a burst may add information, with all of their antennas.
struct ChainLearner::NewArrays {
  Timestamp time;
  RoomObservation observation;
  std::vector<const ArrayObservation*> arrays;  // of the observation
};

ChainLearner::NewArrays ChainLearner::new_of(std::span<const CsiFrame> frames,
                                             Timestamp ChainMemory::*last) {
  NewArrays fresh;
  if (frames.empty()) {
    return fresh;
  }
  fresh.time = frames.back().time;
  const std::vector<RoomAccessPoint>& access_points = localizer_->room().access_points;
  std::vector<char> due(access_points.size());
  for (const CsiFrame& frame : frames) {
    notice_silence(frame);
    const std::size_t a = frame.access_point;
    const std::size_t chains = access_points[a].rx_chains.size();
    due[a] = chains > 1 && chains <= kMaxChains && is_due(a, fresh.time, last) ? 1 : 0;
  }
  if (std::find(due.begin(), due.end(), 1) == due.end()) {
    return fresh;
  }
  fresh.observation = localizer_->receive(undone(first_moment(frames)));
  for (const ArrayObservation& received : fresh.observation.arrays) {
    const std::size_t a = received.map->number();
    if (due[a] == 0 || !has_all_antennas(received)) {
      continue;
    }
    ChainMemory& ap = of(a);
    ap.*last = fresh.time;
    evaluate_waiting(*received.map, localizer_->room().likelihood_exponent, ap);
    const RememberedBurst* before = repeated(received, ap);
    if (before != nullptr) {
      changes_ += ap.confirm_since(before->time) ? 1U : 0U;
    } else if (is_new(received, ap)) {
      ap.last_new = fresh.time;
      ap.before_new = ap.belief.probability();
      fresh.arrays.push_back(&received);
    }
  }
  return fresh;
}

void ChainLearner::receive(std::span<const CsiFrame> frames) {
  const NewArrays fresh = new_of(frames, &ChainMemory::last);
  if (std::any_of(fresh.arrays.begin(), fresh.arrays.end(), [&](const ArrayObservation* received) {
        return of(received->map->number()).state.knowledge == ChainKnowledge::kLearned;
      })) {
    close_.add(*localizer_, known_of(fresh.observation));
  }
  const CellsOfEach unknown = for_any_rotation(fresh);
  for (const ArrayObservation* received : fresh.arrays) {
    const std::size_t a = received->map->number();
    weigh(*received, by_others(fresh.observation, unknown, a), fresh.time, of(a));
  }
  refine_closely();
}

void ChainLearner::receive(std::span<const CsiFrame> frames, const Vec3d& place) {
  const NewArrays fresh = new_of(frames, &ChainMemory::last_fixed);
  for (const ArrayObservation* received : fresh.arrays) {
    weigh_known(*received, place, fresh.time, of(received->map->number()));
  }
}

RoomObservation ChainLearner::known_of(const RoomObservation& observation) const {
  RoomObservation known;
  for (const ArrayObservation& received : observation.arrays) {
    const auto found = aps_.find(received.map->number());
    if (found != aps_.end() && found->second.is_known() && has_all_antennas(received)) {
      known.arrays.push_back(received);
    }
  }
  return known;
}

ChainLearner::CellsOfEach ChainLearner::for_any_rotation(const NewArrays& fresh) {
  CellsOfEach unknown;
  if (fresh.arrays.empty()) {
    return unknown;
  }
  for (const ArrayObservation& received : fresh.observation.arrays) {
    const std::size_t a = received.map->number();
    const bool is_alone = fresh.arrays.size() == 1 && fresh.arrays.front() == &received;
    if (is_alone || !has_all_antennas(received) || of(a).is_known()) {
      continue;
    }
    unknown[a] = places_for_any_rotation(*received.map,
                                         gain_undone(received, of(a)),
                                         of(a).belief.grid(),
                                         localizer_->room().likelihood_exponent,
                                         of(a).belief.probability());
  }
  return unknown;
}

std::vector<double> ChainLearner::by_others(const RoomObservation& observation,
                                            const CellsOfEach& unknown,
                                            std::size_t left_out) const {
  RoomObservation others = known_of(observation);
  std::erase_if(others.arrays, [&](const ArrayObservation& received) {
    return received.map->number() == left_out;
  });
  CellBelief belief(localizer_->grid().size());
  const Localizer::Evidence evidence =
      others.arrays.empty() ? Localizer::Evidence() : localizer_->evidence(others);
  if (!evidence.log_likelihood.empty()) {
    std::vector<double> map = evidence.log_likelihood;
    for (double& one : map) {
      one *= localizer_->room().likelihood_exponent;
    }
    belief.receive(map, std::max(evidence.outlier, kOthersWrong));
  }
  for (const auto& [number, map] : unknown) {
    if (number != left_out) {
      belief.receive(map, kOthersWrong);
    }
  }
  return belief.log_probability();
}

void ChainLearner::weigh(const ArrayObservation& received,
                         std::span<const double> log_weight,
                         Timestamp time,
                         ChainMemory& ap) {
  RememberedBurst burst;
  burst.evidence = turn_evidence(*received.map,
                                 gain_undone(received, ap),
                                 ap.belief.grid(),
                                 localizer_->room().likelihood_exponent,
                                 log_weight);
  burst.log_weight.assign(log_weight.begin(), log_weight.end());
  remember(std::move(burst), received, time, ap);
}

void ChainLearner::weigh_known(const ArrayObservation& received,
                               const Vec3d& place,
                               Timestamp time,
                               ChainMemory& ap) {
  RememberedBurst burst;
  burst.known_place = known_place_model(*received.map, place);
  burst.place = place;
  if (!burst.known_place->reachable) {
    return;
  }
  burst.evidence = turn_evidence_at(*burst.known_place,
                                    gain_undone(received, ap).array,
                                    ap.belief.grid(),
                                    localizer_->room().likelihood_exponent,
                                    received.map->null_model(received.observed));
  remember(std::move(burst), received, time, ap);
}

// `burst` contains its evidence and the data that belong to it.
void ChainLearner::remember(RememberedBurst burst,
                            const ArrayObservation& received,
                            Timestamp time,
                            ChainMemory& ap) {
  const std::vector<double>& log_evidence = burst.evidence.log_evidence;
  const double most = *std::max_element(log_evidence.begin(), log_evidence.end());
  if (most < kMinEvidence) {
    return;
  }
  ap.belief.receive(log_evidence);
  ++changes_;
  ++ap.state.bursts;
  ++ap.unrefined;
  burst.h = received.h;
  burst.time = time;
  burst.noise = received.observed.array.noise;
  burst.floor = burst_floor(*received.map, burst, localizer_->room().likelihood_exponent);
  burst.since.assign(ap.gain.size(), 1.0);
  std::transform(ap.gain.begin(), ap.gain.end(), std::back_inserter(burst.gain), [](auto one) {
    return std::abs(one);
  });
  ap.remember(std::move(burst));
  if (ap.waiting == nullptr) {
    decide(*received.map, time, ap);
  }
}

void ChainLearner::decide(const AccessPointMap& map, Timestamp time, ChainMemory& ap) {
  const bool is_learning = ap.state.knowledge == ChainKnowledge::kLearning;
  const std::span<const RememberedBurst> bursts = bursts_to_compare(time, ap);
  if (bursts.size() < ChainMemory::kMinBursts ||
      (ap.unrefined < kCompareAfter && bursts.size() != kChainBurstsNeeded)) {
    return;
  }
  ap.unrefined = 0;
  const std::vector<ChainFactors> states = compare(map, bursts, ap);
  const ChainFactors& best = states.front();
  const double lead =
      states.size() > 1 ? best.log_evidence - states[1].log_evidence : kChainEvidenceNeeded;
  if (!is_learning) {
    const auto accepted = std::find_if(states.begin(), states.end(), [&](const auto& one) {
      return distance(one.factor, std::vector<Value>(map.antennas(), 1.0)) < kSameState;
    });
    const bool is_suspect = ap.belief.as_accepted() <= kUncertain;
    const bool is_refuted = ap.belief.as_accepted() < kRefuted;
    if (accepted == states.begin() && (!is_refuted || lead >= kWithdrawnLead)) {
      confirm(best, lead, ap);
      return;
    }
    const double needed = is_refuted ? 0.0 : is_suspect ? kWithdrawnLead : kUnsuspectedLead;
    if (accepted == states.end() ? !is_suspect
                                 : best.log_evidence - accepted->log_evidence < needed) {
      return;
    }
    withdraw(time, ap);
    ap.state.bursts = ap.received.size();
  }
  const double sigma = *std::max_element(best.sigma.begin(), best.sigma.end());
  if (ap.received.size() >= kChainBurstsNeeded && lead >= kChainEvidenceNeeded &&
      sigma < kChainPhaseSigmaNeeded) {
    accept(best, ap);
    ap.set_knowledge(ChainKnowledge::kLearned, time);
    ap.last_sure = time;
    return;
  }
  ap.state.evidence = lead;
  ap.state.phase_sigma = sigma;
  const auto counted = static_cast<double>(ap.state.bursts);
  ap.state.bursts_needed = std::clamp(
      static_cast<std::size_t>(std::ceil(counted * kChainEvidenceNeeded / std::max(lead, 1.0))),
      std::max(ap.state.bursts + 1, kChainBurstsNeeded),
      ap.state.bursts + kMaxNeeded);
}

// The accepted state, which `best` refines, is the best. Places within the cells refine it better.
void ChainLearner::confirm(const ChainFactors& best, double lead, ChainMemory& ap) {
  if (!ap.silences.empty() || ap.state.knowledge == ChainKnowledge::kAsCalibrated) {
    if (lead >= kWithdrawnLead) {
      ap.confirm_silences();
    }
  } else if (!close_.includes(ap.state.access_point)) {
    accept(best, ap);
  }
}

void ChainLearner::accept(const ChainFactors& refined, ChainMemory& ap) {
  ap.accept(refined);
  close_.accept(ap.state.access_point, refined.factor);
}

void ChainLearner::refine_closely() {
  if (!close_.is_due()) {
    return;
  }
  for (auto& [access_point, ap] : aps_) {
    if (ap.state.knowledge == ChainKnowledge::kLearned && close_.includes(access_point) &&
        ap.belief.as_accepted() > ChainMemory::kSure) {
      const ChainFactors refined = close_.refined(access_point);
      ap.correct(refined);
      ++changes_;
      close_.accept(access_point, refined.factor);
    }
  }
}

// Refines the states that may be right and returns those that differ, the best first. The
// amplitudes of the best one are used for the following bursts.
std::vector<ChainFactors> ChainLearner::compare(const AccessPointMap& map,
                                                std::span<const RememberedBurst> bursts,
                                                ChainMemory& ap) const {
  std::vector<std::vector<Value>> starts = {std::vector<Value>(map.antennas(), 1.0)};
  if (!ap.favourite.empty()) {
    starts.push_back(ap.favourite);
  }
  for (const std::size_t state : ap.belief.modes(kModes)) {
    std::vector<Value>& start = starts.emplace_back(ap.gain);
    for (std::size_t m = 0; m < start.size(); ++m) {
      start[m] *= std::polar(1.0, ap.belief.grid().phase(state, m));
    }
  }
  std::vector<ChainFactors> different =
      compare_states(map, bursts, starts, localizer_->room().likelihood_exponent);
  ap.favourite = different.front().factor;
  for (std::size_t m = 0; m < ap.gain.size(); ++m) {
    ap.gain[m] = std::abs(ap.favourite[m]);
  }
  return different;
}

FrameFault ChainLearner::fault_of(std::span<const CsiFrame> accepted) const {
  std::set<std::size_t> received;
  FrameFault suspect{1.0};
  for (const CsiFrame& frame : accepted) {
    if (received.insert(frame.access_point).second) {
      const auto found = aps_.find(frame.access_point);
      suspect.probability *=
          found == aps_.end() ? kRotatedAtStart : 1.0 - found->second.belief.as_accepted();
    }
  }
  return received.empty() ? FrameFault() : suspect;
}

void ChainLearner::adopt(const ChainState& state) {
  ChainMemory& ap = of(state.access_point);
  ++changes_;
  ap.received.clear();
  ap.last_new.reset();
  close_.clear();
  ap.accept(state.factors);
  const bool before = are_all_learning();
  ap.state = state;
  withdrawals_ += !before && are_all_learning() ? 1U : 0U;
  ap.last_sure = state.since;
  if (state.knowledge == ChainKnowledge::kLearning) {
    ap.belief.suspect(kRotatedAfterCycle);
  }
  resume(ap);
  if (ap.waiting != nullptr && !ap.waiting->received.empty()) {
    received_.try_emplace(state.access_point, ap.waiting->received.back().time);
  }
}

void ChainLearner::restore(const ChainState& state) {
  aps_.erase(state.access_point);
  restored_[state.access_point] = state;
  of(state.access_point);
}

void ChainLearner::power_cycled(std::size_t access_point, Timestamp time) {
  ChainMemory& ap = of(access_point);
  ++changes_;
  ap.belief.suspect(kRotatedAfterCycle);
  ap.received.clear();
  ap.last_new.reset();
  ap.waiting.reset();
  ap.unevaluated = 0;
  ap.last_sure = time;
  withdraw(time, ap);
}

void ChainLearner::withdraw(Timestamp time, ChainMemory& ap) {
  const bool before = are_all_learning();
  ap.give_up();
  ap.set_knowledge(ChainKnowledge::kLearning, time);
  withdrawals_ += !before && are_all_learning() ? 1U : 0U;
  close_.clear();
}

void ChainLearner::restart() {
  aps_.clear();
  close_.clear();
  received_.clear();
  begin();
}

}  // namespace rayloc
