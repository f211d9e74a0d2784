#include "engine/chains/reference_chains.h"

#include <algorithm>
#include <string>

#include "engine/base/check.h"
#include "engine/chains/chain_frames.h"
#include "engine/chains/state_comparison.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr std::size_t kFrames = 6;  // a count, chosen: bounds the cost of a burst
// [rad], half of the quarter turn that chips start apart. Smaller factors are refinements, with
// which both comparisons fit.
constexpr double kRotated = 0.785;
// A burst is clear if one comparison leaves at most this share of the power that the other leaves
// unexplained; chosen as in CalibrationMonitor.
constexpr double kClear = 0.5;
// A share, chosen: a chain a quarter turn off leaves more than that of four chains, 0.37.
constexpr double kMaxUnexplained = 0.3;

bool is_rotated(const ChainState& state) {
  const std::vector<Value>& factor = state.factors.factor;
  return distance(factor, std::vector<Value>(factor.size(), 1.0)) > kRotated;
}

// The first frames of one access point.
std::vector<CsiFrame> first_of(std::span<const CsiFrame> frames, std::size_t access_point) {
  std::vector<CsiFrame> first;
  for (const CsiFrame& frame : frames) {
    if (frame.access_point == access_point && first.size() < kFrames) {
      first.push_back(frame);
    }
  }
  return first;
}

}  // namespace

ReferenceChains::ReferenceChains(std::shared_ptr<const RoomModel> room)
    : room_(std::move(room)), aligner_(room_->grid) {}

void ReferenceChains::add(const MacAddress& transmitter,
                          std::size_t access_point,
                          std::vector<Value> empty) {
  RAYLOC_CHECK(empty.size() == room_->access_points.at(access_point).gains.gain.size());
  links_[{transmitter, access_point}] = {std::move(empty), std::nullopt, {}, {}};
}

// Share of the frames' power that the array of the link does not explain; nothing: not usable.
std::optional<double> ReferenceChains::unexplained(const Link& link,
                                                   std::size_t access_point,
                                                   std::span<const CsiFrame> frames) const {
  std::vector<std::string> warnings;
  const auto burst = preprocess_burst(*room_, access_point, frames, {}, warnings);
  if (!burst) {
    return std::nullopt;
  }
  return 1.0 - aligner_.align(link.empty, burst->h).correlation;
}

std::optional<bool> ReferenceChains::contains(const Link& link,
                                              const std::vector<Value>& factors,
                                              const ChainState& state,
                                              std::span<const CsiFrame> frames) const {
  const std::size_t a = state.access_point;
  const RoomAccessPoint& ap = room_->access_points[a];
  std::vector<CsiFrame> first = first_of(frames, a);
  undo(state, ap, first);
  const std::optional<double> without = unexplained(link, a, first);
  for (CsiFrame& frame : first) {
    multiply(ap, factors, frame);
  }
  const std::optional<double> with = unexplained(link, a, first);
  if (!without || !with) {
    return std::nullopt;
  }
  const double least = std::min(*without, *with);
  if (least > kMaxUnexplained || least > kClear * std::max(*without, *with)) {
    return std::nullopt;
  }
  return *with < *without;
}

void ReferenceChains::decide(const ChainState& state,
                             std::span<const CsiFrame> frames,
                             Link& link) const {
  const std::vector<Value>& learned = state.factors.factor;
  const std::optional<bool> has_learned = contains(link, learned, state, frames);
  if (!has_learned) {
    return;
  }
  link.presumed = *has_learned ? learned : std::vector<Value>();
  // An array that fits without the learned factors confirms these itself.
  if (state.is_confirmed || !*has_learned) {
    link.recorded = link.presumed;
    link.decided_with = learned;
  }
}

// Factors that were wrong at the decision are not in the array: it then fits without them.
void ReferenceChains::verify(const ChainState& state,
                             std::span<const CsiFrame> frames,
                             Link& link) const {
  const std::vector<Value>& learned = state.factors.factor;
  if (link.recorded->empty() || !state.is_confirmed ||
      distance(learned, link.decided_with) < kRotated) {
    return;
  }
  const std::optional<bool> is_right = contains(link, *link.recorded, state, frames);
  if (is_right) {
    link.decided_with = learned;
    link.recorded = *is_right ? *link.recorded : std::vector<Value>();
    link.presumed = *link.recorded;
  }
}

void ReferenceChains::observe(const MacAddress& transmitter,
                              std::span<const CsiFrame> frames,
                              std::span<const ChainState> states) {
  for (const ChainState& state : states) {
    const auto found = links_.find({transmitter, state.access_point});
    if (found == links_.end()) {
      continue;
    }
    Link& link = found->second;
    if (link.recorded) {
      if (state.knowledge == ChainKnowledge::kLearned) {
        verify(state, frames, link);
      }
    } else if (state.knowledge == ChainKnowledge::kLearned && is_rotated(state)) {
      decide(state, frames, link);
    } else {
      link.presumed.clear();
    }
  }
}

std::vector<Value> ReferenceChains::recorded(const MacAddress& transmitter,
                                             std::size_t access_point) const {
  const auto found = links_.find({transmitter, access_point});
  return found == links_.end() ? std::vector<Value>()
                               : found->second.recorded.value_or(std::vector<Value>());
}

std::vector<Value> ReferenceChains::presumed(const MacAddress& transmitter,
                                             std::size_t access_point) const {
  const auto found = links_.find({transmitter, access_point});
  return found == links_.end() ? std::vector<Value>() : found->second.presumed;
}

bool ReferenceChains::is_undecided(const MacAddress& transmitter, std::size_t access_point) const {
  const auto found = links_.find({transmitter, access_point});
  return found != links_.end() && !found->second.recorded;
}

void ReferenceChains::restart() {
  for (auto& [key, link] : links_) {
    link = {std::move(link.empty), std::nullopt, {}, {}};
  }
}

}  // namespace rayloc
