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
// all delays are searched (every fourth, then eight around the best); with one the eight around it.
// Neighbours are clamped into the search. REQUIRES: box.is_reachable(), equal dimensions.
void whiten_delays_of_box(const PlaceBox& box,
                          const DelayRows& burst,
                          std::optional<std::size_t> hint,
                          BoxBurst& out);

struct BoxPlaces {  // [m], from the middle of the box; equal sizes, any number
  std::span<const float> x;
  std::span<const float> y;
  std::span<const float> z;
};

// out[i]: log-likelihood at the best gain, phase and of the kept delays, less log_determinant.
// tries_obstructed: also without the line of sight (kLogObstructed). Returns the number of places
// where that is the larger one. REQUIRES: box.is_reachable(), out.size() == places,
// burst: of this box.
std::size_t evaluate_places_of_box(const PlaceBox& box,
                                   const BoxBurst& burst,
                                   const BoxPlaces& places,
                                   bool tries_obstructed,
                                   std::span<float> out);

// Prefetches every cache line of the block while another box is in use.
void fetch_box(const PlaceBox& box);

}  // namespace rayloc
