#include "engine/calibrate/joint/wave_cycles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/parallel.h"

namespace rayloc {
namespace {

using Kind = Unknown::Kind;

// Cost decrease of an improvement: more than extra iterations gain if nothing has moved.
constexpr double kMinGain = 1.0;
constexpr int kMaxSurfacePasses =
    8;  // over all surfaces, at most: a moved surface can correct another one
constexpr std::size_t kPaired = 4;  // first surfaces that are tried in pairs
// Moves for which the whole room is fitted anew: those of lowest cost while most of it is held.
constexpr std::size_t kFittedAnew = 4;

// Surfaces that are moved together, and the side of each.
struct Move {
  std::vector<std::uint32_t> surfaces;
  std::vector<double> sides;
};

struct Trial {
  JointState state;
  double cost = 0.0;
  double excess = 0.0;  // of its cost, with most of the room held
};

// Unknowns that can hide a wrong cycle: the surfaces themselves, the arrays and, depending on
// JointOptions, the survey errors.
std::vector<char> released_in_trial(const RoomUnknowns& unknowns,
                                    std::span<const std::uint32_t> surfaces,
                                    std::span<const char> released) {
  std::vector<char> result(unknowns.size());
  for (std::uint32_t i = 0; i < unknowns.size(); ++i) {
    switch (unknowns[i].kind) {
      case Kind::kSurfaceOffset:
      case Kind::kSurfaceGain:
      case Kind::kSurfacePhase:
        if (std::find(surfaces.begin(), surfaces.end(), unknowns[i].index) != surfaces.end()) {
          result[i] = released[i];
        }
        break;
      case Kind::kPermittivity:
      case Kind::kConductivity:
      case Kind::kThickness:
        break;
      default:
        result[i] = released[i];
    }
  }
  return result;
}

JointState shifted_state(const JointState& state,
                         const RoomUnknowns& unknowns,
                         const Move& move,
                         double half_wave) {
  JointState result = state;
  for (std::size_t i = 0; i < move.surfaces.size(); ++i) {
    const std::uint32_t surface = move.surfaces[i];
    result.values[unknowns.surface_offset(surface)] += move.sides[i] * half_wave;
    result.values[unknowns.surface_gain(surface)] = 0.0;
    result.values[unknowns.surface_phase(surface)] = 0.0;
  }
  return result;
}

class WaveCycleSettler {
 public:
  WaveCycleSettler(const JointContext& context, const WaveCycleSearch& search, JointState& state)
      : unknowns_(context.unknowns), search_(search), problem_(context), state_(state) {}

  WaveCycles run();

 private:
  bool stop();
  bool try_single(std::vector<WaveCycle>& others);
  bool try_pairs();
  bool fit_anew();
  bool try_moves(std::span<const Move> moves, std::vector<WaveCycle>* others);
  template <typename From>
  std::vector<Trial> fitted(const JointOptions& options, std::size_t count, const From& from) const;

  const RoomUnknowns& unknowns_;
  const WaveCycleSearch& search_;
  JointProblem problem_;
  JointState& state_;
  std::vector<Trial> worse_;  // of this pass
  bool stopped_ = false;
};

bool WaveCycleSettler::stop() {
  stopped_ = stopped_ || (search_.go_on && !search_.go_on());
  return stopped_;
}

// Fits from each from(i), all in parallel: the serial part of Ceres between two evaluations takes
// as long as one evaluation on all threads.
template <typename From>
std::vector<Trial> WaveCycleSettler::fitted(const JointOptions& options,
                                            std::size_t count,
                                            const From& from) const {
  std::vector<Trial> trials(count);
  parallel_for(count, 1, [&](std::size_t i) {
    trials[i].state = from(i);
    trials[i].cost = problem_.solve(options, trials[i].state, {});
  });
  return trials;
}

// Tries moves of the same surfaces; returns true if one was better.
bool WaveCycleSettler::try_moves(std::span<const Move> moves, std::vector<WaveCycle>* others) {
  if (stopped_) {
    return false;
  }
  const auto free = released_in_trial(unknowns_, moves.front().surfaces, search_.options.released);
  JointOptions options = search_.options;
  options.released = free;
  // Only the priors of released unknowns count.
  double cost = problem_.cost(options, state_);
  if (stop()) {
    return false;
  }
  const std::vector<Trial> trials = fitted(options, moves.size(), [&](std::size_t i) {
    return shifted_state(state_, unknowns_, moves[i], search_.half_wave);
  });
  bool better = false;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const Trial& trial = trials[i];
    if (trial.cost < cost - kMinGain) {
      state_ = trial.state;
      cost = trial.cost;
      better = true;
      continue;
    }
    if (others != nullptr) {
      const std::uint32_t surface = moves[i].surfaces.front();
      others->push_back(
          {surface, trial.state.values[unknowns_.surface_offset(surface)], trial.cost - cost});
    }
    worse_.push_back({trial.state, trial.cost, trial.cost - cost});
  }
  return better;
}

bool WaveCycleSettler::try_single(std::vector<WaveCycle>& others) {
  bool better = false;
  for (const std::uint32_t surface : search_.surfaces) {
    const std::array<Move, 2> moves{{{{surface}, {-1.0}}, {{surface}, {1.0}}}};
    better = try_moves(moves, &others) || better;
  }
  return better;
}

bool WaveCycleSettler::try_pairs() {
  const std::size_t paired = std::min(search_.surfaces.size(), kPaired);
  for (std::size_t a = 0; a < paired; ++a) {
    for (std::size_t b = a + 1; b < paired; ++b) {
      const std::vector<std::uint32_t> pair{search_.surfaces[a], search_.surfaces[b]};
      const std::array<Move, 4> moves{
          {{pair, {-1.0, -1.0}}, {pair, {-1.0, 1.0}}, {pair, {1.0, -1.0}}, {pair, {1.0, 1.0}}}};
      if (try_moves(moves, nullptr)) {
        return true;
      }
    }
  }
  return false;
}

// Needed where the rest of the room has adapted to the wrong cycle and holds it there.
bool WaveCycleSettler::fit_anew() {
  std::sort(worse_.begin(), worse_.end(), [](const Trial& a, const Trial& b) {
    return a.excess < b.excess;
  });
  const double cost = problem_.cost(search_.options, state_);
  if (stop()) {
    return false;
  }
  const std::vector<Trial> trials = fitted(search_.options,
                                           std::min(worse_.size(), kFittedAnew),
                                           [&](std::size_t i) { return worse_[i].state; });
  for (const Trial& trial : trials) {
    if (trial.cost < cost - kMinGain) {
      state_ = trial.state;
      return true;
    }
  }
  return false;
}

WaveCycles WaveCycleSettler::run() {
  WaveCycles result;
  bool better = true;
  for (int pass = 0; pass < kMaxSurfacePasses && better; ++pass) {
    result.others.clear();
    worse_.clear();
    better = try_single(result.others) || try_pairs() || fit_anew();
    result.moved = result.moved || better;
  }
  if (better) {  // the last pass was too short to list the alternatives
    result.others.clear();
    try_single(result.others);
  }
  return result;
}

}  // namespace

WaveCycles settle_wave_cycles(const JointContext& context,
                              const WaveCycleSearch& search,
                              JointState& state) {
  return WaveCycleSettler(context, search, state).run();
}

void widen_by_wave_cycles(std::span<const WaveCycle> others,
                          const RoomUnknowns& unknowns,
                          const JointState& state,
                          std::vector<double>& sigma) {
  for (const WaveCycle& other : others) {
    const std::uint32_t unknown = unknowns.surface_offset(other.surface);
    const double odds = std::exp(-std::max(other.excess, 0.0));
    const double off = other.offset - state.values[unknown];
    sigma[unknown] = std::hypot(sigma[unknown], std::abs(off) * std::sqrt(odds / (1.0 + odds)));
  }
}

}  // namespace rayloc
