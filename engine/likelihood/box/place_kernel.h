// PlaceKernel: log-likelihoods of a burst at places of a PlaceBox, eight at a time, with the widest
// vectors that the processor has for eight floats. The result does not depend on the number of
// places or threads; it differs by rounding between kinds of processors.
//
// Thread safety: functions of their arguments.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "engine/likelihood/box/delay_rows.h"
#include "engine/likelihood/box/place_box.h"

namespace rayloc {

inline constexpr std::size_t kBoxDelays = 3;  // a count: the best delay and its neighbours

// A burst whitened by a box at the best delay and its neighbours.
struct BoxBurst {
  std::size_t delay = 0;                  // the best one, of ObservedArray's
  std::array<float, kBoxDelays> power{};  // |W y|^2, at least kMinSinglePower
  // [delay][coordinate]{re, im}, as many coordinates as the box has
  std::array<float, 2 * kBoxDelays * kMaxBoxDimension> whitened;
};

// The best delay is the one that fits the middle of the box, line of sight clear. Without a hint
// every fourth delay is evaluated, then the eight around the best; with one, the eight around it.
// If the best is the first or last of the eight, the eight around it are evaluated too. Neighbours
// are clamped into the search. REQUIRES: box.is_reachable(), equal dimensions.
void whiten_delays_of_box(const PlaceBox& box,
                          const DelayRows& burst,
                          std::optional<std::size_t> hint,
                          BoxBurst& out);

struct BoxPlaces {  // [m], from the middle of the box; equal sizes, any number
  std::span<const float> x;
  std::span<const float> y;
  std::span<const float> z;
};

// out[i]: log-likelihood at the best gain, phase and of the kept delays, less log_determinant. With
// box.has_direct, it is the larger one of those with and without the line of sight
// (kLogObstructed). REQUIRES: box.is_reachable(), out.size() == places, burst: of this box.
void evaluate_places_of_box(const PlaceBox& box,
                            const BoxBurst& burst,
                            const BoxPlaces& places,
                            std::span<float> out);

}  // namespace rayloc
