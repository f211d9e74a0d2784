// Shooting and bouncing rays: which sequences of mirrors waves from a point meet.
//
// Rays leave the point in the directions of a Fibonacci lattice; where one meets a surface it is
// reflected and, with transmission, also goes straight on. What each has met so far is a sequence
// of surfaces (planes of an object, not triangles). The set of all sequences proposes mirrors to
// the image tree, which finds the exact paths; rays themselves are no part of a result.
//
// What may be missed: a sequence whose beam passes between the rays. It narrows with every mirror
// and with the mirror's size seen from the root, so what is missed are mostly late and small
// mirrors (engine/studies/2026-11-ray-tracer.md has the shares); with soft edges also
// what only the soft part of an edge reaches; with transmission, of two faces of different objects
// nearer to each other than rays can tell, what is reflected at the one behind. Everything that one
// ray meets is found.
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
  std::size_t segments = 0;  // that the rays made
};

// options.rays rays. The same whatever the number of threads.
ShotMirrors shoot_mirrors(const Scene& scene, const Vec3d& root, const TraceOptions& options);

}  // namespace rayloc
