#include "engine/chains/chain_memory.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace rayloc {
namespace {

using Value = std::complex<double>;

// Probability of a power cycle during the first silence: it may have been off, or only silent. It
// is the mean of a beta distribution of weight 1, so n harmless silences divide it by 1 + n.
constexpr double kRotatedAfterSilence = 0.3;
constexpr double kLeastRotated = 0.01;   // a probability: access points are restarted now and then
constexpr std::size_t kMaxSilences = 8;  // a count, chosen: 2 kB each
constexpr double kFineSigma = 0.035;  // [rad], 2 degrees: accurate enough for infrequent evaluation

}  // namespace

ChainMemory::ChainMemory(std::size_t chains, double rotated)
    : belief(chains, rotated), gain(chains, 1.0) {
  state.factors = ChainFactors::unity(chains);
}

bool ChainMemory::is_known() const {
  return state.knowledge == ChainKnowledge::kLearned ||
         (state.knowledge == ChainKnowledge::kAsCalibrated && received.size() >= kMinBursts &&
          belief.as_accepted() > kSure);
}

bool ChainMemory::is_settled() const {
  const auto& sigma = state.factors.sigma;
  return state.knowledge != ChainKnowledge::kLearning && received.size() >= kMinBursts &&
         belief.as_accepted() > kSure &&
         (*std::max_element(sigma.begin(), sigma.end()) < kFineSigma || received.size() == kMost);
}

void ChainMemory::set_knowledge(ChainKnowledge knowledge, Timestamp time) {
  state.knowledge = knowledge;
  state.since = time;
  state.bursts = 0;
  state.bursts_needed = 0;
  state.evidence = 0.0;
  state.phase_sigma = 0.0;
}

void ChainMemory::suspect_after_silence(Timestamp end) {
  if (silences.size() == kMaxSilences) {
    silences.erase(silences.begin());
  }
  const double rotated = kRotatedAfterSilence / (1.0 + static_cast<double>(harmless_silences));
  silences.push_back({end, belief.suspect_for_now(std::max(rotated, kLeastRotated))});
}

bool ChainMemory::confirm_since(Timestamp time) {
  const auto first = std::find_if(
      silences.begin(), silences.end(), [&](const Silence& one) { return one.end > time; });
  const bool is_any = first != silences.end();
  for (auto one = first; one != silences.end(); ++one) {
    belief.multiply(one->undoing);
    ++harmless_silences;
  }
  silences.erase(first, silences.end());
  return is_any;
}

// While a later silence is open the belief keeps the suspicion of the earlier ones: undoing it
// would undo that of the later one as well.
void ChainMemory::confirm_silences() {
  const auto first_open = std::find_if(silences.begin(), silences.end(), [&](const Silence& one) {
    return bursts_since(one).size() < kChainBurstsNeeded;
  });
  harmless_silences += static_cast<std::size_t>(first_open - silences.begin());
  silences.erase(silences.begin(), first_open);
  if (silences.empty()) {
    settle();
  }
}

std::span<const RememberedBurst> ChainMemory::bursts_since(const Silence& silence) const {
  const auto first =
      std::find_if(received.begin(), received.end(), [&](const RememberedBurst& one) {
        return one.time >= silence.end;
      });
  return {first, received.end()};
}

std::span<const RememberedBurst> ChainMemory::bursts_since_silence() const {
  const auto newest = std::find_if(silences.rbegin(), silences.rend(), [&](const Silence& one) {
    return bursts_since(one).size() >= kChainBurstsNeeded;
  });
  if (newest != silences.rend()) {
    return bursts_since(*newest);
  }
  return silences.empty() ? std::span<const RememberedBurst>(received)
                          : bursts_since(silences.front());
}

void ChainMemory::end_silences() {
  harmless_silences += silences.size();
  silences.clear();
}

void ChainMemory::settle() {
  belief.settle();
  silences.clear();
}

void ChainMemory::give_up() {
  const auto forgotten =
      static_cast<std::ptrdiff_t>(received.size() - bursts_since_silence().size());
  received.erase(received.begin(), received.begin() + forgotten);
  silences.clear();
  harmless_silences = 0;
}

void ChainMemory::remember(RememberedBurst burst) {
  if (received.size() == kMost) {
    received.erase(received.begin());
  }
  received.push_back(std::move(burst));
}

void ChainMemory::forget_until_sure() {
  const auto after = std::find_if(received.begin(),
                                  received.end(),
                                  [&](const RememberedBurst& one) { return one.time > last_sure; });
  received.erase(received.begin(), after);
}

void ChainMemory::correct(const ChainFactors& refined) {
  const std::vector<Value> undoing = inverses(refined.factor);
  for (RememberedBurst& one : received) {
    multiply(undoing, one.h);
    for (std::size_t m = 0; m < one.since.size(); ++m) {
      one.since[m] *= refined.factor[m];
      one.gain[m] /= std::abs(refined.factor[m]);
    }
  }
  for (std::size_t m = 0; m < gain.size(); ++m) {
    state.factors.factor[m] *= refined.factor[m];
  }
  state.factors.sigma = refined.sigma;
  state.factors.log_gain_sigma = refined.log_gain_sigma;
  state.factors.log_evidence = refined.log_evidence;
  std::fill(gain.begin(), gain.end(), 1.0);
  favourite.clear();
}

void ChainMemory::accept(const ChainFactors& refined) {
  correct(refined);
  unrefined = 0;
  settle();
}

}  // namespace rayloc
