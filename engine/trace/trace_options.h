// TraceOptions: the kinds of paths that a tracer searches.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rayloc {

// A count of reflections, chosen: the default of Sionna RT.
inline constexpr int kDefaultMaxDepth = 3;
// A count, measured: with so many rays none of 13,791 paths of three rooms is missed.
inline constexpr std::size_t kDefaultRays = std::size_t{1} << 18U;

// A count, chosen: reflections and crossings on each side of an edge.
inline constexpr int kMaxBesideEdge = 2;

// Method that proposes the sequences of mirrors.
enum class CandidateGenerator : std::uint8_t {
  kAutomatic,   // exhaustive where that is possible, otherwise shooting (image_tree.h)
  kExhaustive,  // every sequence that geometry allows: for rooms and flats
  kShooting,    // sequences met by rays (shooting.h): for large scenes and great depths
};

struct TraceOptions {
  // Reflections, and with `transmission` crossings of faces too: a wall of two faces counts as two.
  int max_depth = kDefaultMaxDepth;
  // Waves also pass straight through objects. Otherwise every surface is opaque.
  bool transmission = false;
  // Distance from its edge over which a surface begins to reflect and to shadow [m] (visibility.h);
  // 0: hard edges, as in geometrical optics.
  double softness = 0.0;
  // Waves are also diffracted at one edge, with up to kMaxBesideEdge interactions on each side
  // (diffraction/edge_finder.h); the edge counts towards max_depth. Hard edges only.
  bool diffraction = false;
  // Also at two edges in a row (diffraction/edge_pair_finder.h), which count towards max_depth;
  // requires `diffraction`.
  bool double_diffraction = false;
  // Rough materials (em/surface_scattering.h) reflect less: diffuse/ computes the scattered part.
  // If false all surfaces are smooth, whatever their materials state.
  bool diffuse = false;
  CandidateGenerator candidates = CandidateGenerator::kAutomatic;
  std::size_t rays = kDefaultRays;  // number of shot rays, > 0
};

}  // namespace rayloc
