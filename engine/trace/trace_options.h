// TraceOptions: which paths a tracer looks for.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rayloc {

// A count of reflections, chosen: as Sionna RT has it.
inline constexpr int kDefaultMaxDepth = 3;
// A count, measured: of 13,791 paths of three rooms so many rays miss none.
inline constexpr std::size_t kDefaultRays = std::size_t{1} << 18U;

// A count, chosen: reflections and crossings on each side of an edge.
inline constexpr int kMostBesideEdge = 2;

// Who proposes the sequences of mirrors.
enum class CandidateGenerator : std::uint8_t {
  kAutomatic,   // exhaustive where that is possible, else shooting (image_tree.h)
  kExhaustive,  // every sequence that geometry allows: for rooms and flats
  kShooting,    // what rays meet (shooting.h): for large scenes and great depths
};

struct TraceOptions {
  // Reflections, and with `transmission` crossings of faces too: a wall of two faces is two.
  int max_depth = kDefaultMaxDepth;
  // Waves also go straight on through objects. Else every surface is opaque.
  bool transmission = false;
  // Over what distance from its edge a surface begins to reflect and to shadow [m] (visibility.h);
  // 0: at the edge, as real surfaces of the geometrical optics do.
  double softness = 0.0;
  // Waves also turn at one edge, with at most kMostBesideEdge interactions before it and as many
  // after it (diffraction/edge_finder.h); the edge counts for max_depth. With hard edges only.
  bool diffraction = false;
  // Also at two edges in a row (diffraction/edge_pair_finder.h), which count for max_depth; with
  // `diffraction` alone.
  bool double_diffraction = false;
  // Rough materials (em/surface_scattering.h) reflect less: what they scatter is a matter of
  // diffuse/. Without it all surfaces are smooth, whatever their materials state.
  bool diffuse = false;
  CandidateGenerator candidates = CandidateGenerator::kAutomatic;
  std::size_t rays = kDefaultRays;  // that are shot, > 0
};

}  // namespace rayloc
