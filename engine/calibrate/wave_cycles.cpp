#include "engine/calibrate/wave_cycles.h"

#include <cmath>
#include <utility>

namespace rayloc {
namespace {

using Kind = Unknown::Kind;

constexpr int kPasses = 3;  // over all surfaces, at most: one that moves can set another right

// What can hide a wrong cycle: the surface itself, the arrays and, as JointOptions say, the survey.
std::vector<char> released_in_trial(const RoomUnknowns& unknowns,
                                    std::uint32_t surface,
                                    std::span<const char> released) {
  std::vector<char> result(unknowns.size());
  for (std::uint32_t i = 0; i < unknowns.size(); ++i) {
    switch (unknowns[i].kind) {
      case Kind::kSurfaceOffset:
      case Kind::kSurfaceGain:
      case Kind::kSurfacePhase:
        result[i] = unknowns[i].index == surface ? released[i] : 0;
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

JointState moved(const JointState& state,
                 const RoomUnknowns& unknowns,
                 std::uint32_t surface,
                 double by) {
  JointState result = state;
  result.values[unknowns.surface_offset(surface)] += by;
  result.values[unknowns.surface_gain(surface)] = 0.0;
  result.values[unknowns.surface_phase(surface)] = 0.0;
  return result;
}

}  // namespace

WaveCycles settle_wave_cycles(const JointContext& context,
                              const WaveCycleSearch& search,
                              JointState& state) {
  const JointProblem problem(context);
  const RoomUnknowns& unknowns = context.unknowns;
  WaveCycles result;
  bool better = true;
  for (int pass = 0; pass < kPasses && better; ++pass) {
    better = false;
    result.others.clear();
    for (const std::uint32_t surface : search.surfaces) {
      const auto free = released_in_trial(unknowns, surface, search.options.released);
      JointOptions options = search.options;
      options.released = free;
      // The priors that count are those of what is released.
      double cost = problem.cost(options, state);
      const JointState from = state;
      for (const double side : {-1.0, 1.0}) {
        if (search.go_on && !search.go_on()) {
          return result;
        }
        JointState trial = moved(from, unknowns, surface, side * search.half_wave);
        const double reached = problem.solve(options, trial, {});
        if (reached < cost) {
          state = std::move(trial);
          cost = reached;
          better = true;
        } else {
          const double offset = trial.values[unknowns.surface_offset(surface)];
          result.others.push_back({surface, offset, reached - cost});
        }
      }
    }
    result.moved = result.moved || better;
  }
  return result;
}

void widen_by_wave_cycles(std::span<const WaveCycle> others,
                          const RoomUnknowns& unknowns,
                          const JointState& state,
                          std::vector<double>& sigma) {
  for (const WaveCycle& other : others) {
    const std::uint32_t unknown = unknowns.surface_offset(other.surface);
    const double odds = std::exp(-other.excess);
    const double off = other.offset - state.values[unknown];
    sigma[unknown] = std::hypot(sigma[unknown], std::abs(off) * std::sqrt(odds / (1.0 + odds)));
  }
}

}  // namespace rayloc
