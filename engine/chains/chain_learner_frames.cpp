// ChainLearner: frames with the factors of their chains removed, silences, bursts with the same
// information, and its state for others.
#include <algorithm>
#include <chrono>
#include <span>
#include <vector>

#include "engine/chains/chain_frames.h"
#include "engine/chains/chain_learner.h"
#include "engine/chains/chain_record.h"

namespace rayloc {
namespace {

constexpr auto kSilence = std::chrono::seconds(20);  // chosen: access points start in a minute
constexpr double kSameCorrelation = 0.9;  // correlation of bursts with the same information
constexpr double kMaxNoise = 2e-3;  // of a burst, as share of its power, like ModelError::noise

// Element of `bursts` with the same information, or their end.
auto same_as(const ArrayObservation& received, const Aligner& aligner, const auto& bursts) {
  return std::find_if(bursts.begin(), bursts.end(), [&](const auto& one) {
    return aligner.align(one.h, received.h).correlation > kSameCorrelation;
  });
}

}  // namespace

const RememberedBurst* ChainLearner::repeated(const ArrayObservation& received,
                                              const ChainMemory& ap) const {
  const auto found = same_as(received, aligner_, ap.received);
  return found == ap.received.end() ? nullptr : &*found;
}

bool ChainLearner::is_new(const ArrayObservation& received, const ChainMemory& ap) const {
  if (received.observed.array.noise > kMaxNoise) {
    return false;
  }
  if (ap.waiting == nullptr) {
    return true;
  }
  const auto waiting = std::span(ap.waiting->received).first(ap.unevaluated);
  return same_as(received, aligner_, waiting) == waiting.end();
}

// An access point that is off receives no frames.
void ChainLearner::notice_silence(const CsiFrame& frame) {
  const std::size_t a = frame.access_point;
  const auto [last, is_first] = received_.emplace(a, frame.time);
  if (!is_first && frame.time - last->second > kSilence) {
    if (const auto found = aps_.find(a); found != aps_.end()) {
      found->second.suspect_after_silence(frame.time);
    }
  }
  last->second = frame.time;
}

std::vector<CsiFrame> ChainLearner::undone(std::span<const CsiFrame> frames) const {
  std::vector<CsiFrame> result(frames.begin(), frames.end());
  for (const auto& [number, learned] : aps_) {
    if (learned.state.knowledge != ChainKnowledge::kAsCalibrated) {
      undo(learned.state, localizer_->room().access_points[number], result);
    }
  }
  return result;
}

std::vector<CsiFrame> ChainLearner::accepted(std::span<const CsiFrame> frames) const {
  std::vector<CsiFrame> kept = undone(frames);
  std::erase_if(kept, [&](const CsiFrame& frame) {
    const auto found = aps_.find(frame.access_point);
    return found != aps_.end() && found->second.state.knowledge == ChainKnowledge::kLearning;
  });
  return kept;
}

bool ChainLearner::leaves_alone() const {
  return std::all_of(aps_.begin(), aps_.end(), [](const auto& one) {
    return one.second.state.knowledge == ChainKnowledge::kAsCalibrated;
  });
}

bool ChainLearner::are_all_learning() const {
  return std::all_of(aps_.begin(), aps_.end(), [](const auto& one) {
    return one.second.state.knowledge == ChainKnowledge::kLearning;
  });
}

std::vector<ChainState> ChainLearner::states() const {
  std::vector<ChainState> result;
  for (const auto& [access_point, ap] : aps_) {
    result.push_back(ap.state);
  }
  return result;
}

std::optional<ChainRecord> ChainLearner::record(std::size_t access_point) const {
  const auto found = aps_.find(access_point);
  return found == aps_.end() ? std::nullopt : record_of(found->second);
}

// receive() evaluates a burst at the time of its last frame. A burst that it does not evaluate, or
// that resembles a remembered one, has no belief: its evidence is that of an earlier burst.
std::vector<std::vector<double>> ChainLearner::beliefs_before(
    std::span<const CsiFrame> frames) const {
  std::vector<std::vector<double>> beliefs(localizer_->room().access_points.size());
  for (const auto& [access_point, ap] : aps_) {
    if (ap.state.knowledge == ChainKnowledge::kLearning && !frames.empty() &&
        ap.last_new == frames.back().time) {
      beliefs[access_point] = ap.before_new;
    }
  }
  return beliefs;
}

}  // namespace rayloc
