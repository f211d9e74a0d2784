// Shooting and bouncing rays: the sequences of mirrors that waves from a point meet.
//
// Rays leave the point in the directions of a Fibonacci lattice; a ray that meets a surface is
// reflected and, with transmission, also continues straight. The surfaces that each has met so far
// are a sequence (planes of an object, not triangles). The set of all sequences proposes mirrors to
// the image tree, which finds the exact paths; rays themselves are no part of a result.
//
// Sequences that may be missed: those whose beam passes between the rays. A beam narrows with
// every mirror and with the mirror's size seen from the root, so mostly late and small mirrors
// are missed (engine/studies/2026-11-ray-tracer.md has the shares); with soft edges also paths
// that only the soft part of an edge reaches; with transmission, for two faces of different
// objects too close together for rays to separate, reflections at the rear one. Every sequence
// that one ray meets is found.
//
// References: H. Ling, R.-C. Chou, S.-W. Lee, IEEE Trans. Antennas Propag. 37 (1989) 194.
#pragma once

#include <cstddef>

#include "engine/scene/scene.h"
#include "engine/trace/images/mirror_trie.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct ShotMirrors {
  MirrorTrie trie;           // in order
  std::size_t segments = 0;  // number of ray segments
};

// Shoots options.rays rays. The result does not depend on the number of threads.
ShotMirrors shoot_mirrors(const Scene& scene, const Vec3d& root, const TraceOptions& options);

}  // namespace rayloc
