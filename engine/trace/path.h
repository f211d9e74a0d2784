// Path: one propagation path from a transmitter to a receiver.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/complex.h"
#include "engine/base/vec3.h"
#include "engine/em/spherical.h"
#include "engine/trace/interactions/interaction_kind.h"

namespace rayloc {

inline constexpr std::uint32_t kNoEdge = 0xffffffff;  // no index: not at an edge

struct Interaction {
  InteractionKind kind = InteractionKind::kReflection;
  std::uint32_t object = 0;   // index into Scene::objects()
  std::uint32_t surface = 0;  // index into Scene::surfaces(); of an edge its face 0
  Vec3d position;             // [m], world: intersection of path and surface
  double weight = 1.0;        // below 1 only with soft visibility (visibility.h)
  // A crossing of a face that coincides with the mirror before or after it (coplanar_faces.h).
  bool at_mirror = false;
  // For two diffractions at edges of one face: the path between them follows face n of the first,
  // otherwise its face 0 (diffraction/edge_pair.h).
  bool along_face_n = false;
  std::uint32_t edge = kNoEdge;  // of a diffraction: index into TraceContext::wedges
};

struct Path {
  // (lambda / 4 pi) C_R^H T C_T: antenna patterns, interactions and spreading at the carrier,
  // WITHOUT the propagation phase. h(f) = sum a exp(-j 2 pi f tau), f absolute.
  Complex<double> a;
  double tau = 0.0;  // [s]
  Vec3d departure;   // unit, world: direction of travel at the transmitter
  Vec3d arrival;     // unit, world: from the receiver towards the arriving wave
  std::vector<Interaction> interactions;  // from the transmitter on; empty: line of sight

  // Zenith and azimuth of the two directions [rad].
  double theta_t() const { return spherical_angles(departure).theta; }
  double phi_t() const { return spherical_angles(departure).phi; }
  double theta_r() const { return spherical_angles(arrival).theta; }
  double phi_r() const { return spherical_angles(arrival).phi; }
};

}  // namespace rayloc
