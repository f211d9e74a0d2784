// The baseline of a query: the paths of a link when the surfaces that they touch are given.
//
// Vertices by the image method and the field, nothing else: no search, no test of occlusion, no
// memory taken. A tracer cannot be faster than this.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/trace/field_calculator.h"
#include "engine/trace/path_tracer.h"

namespace rayloc::bench {

class KnownPaths {
 public:
  // The sequences of the paths that `at`, of the tracer, finds. REQUIRES: all interactions are
  // reflections.
  KnownPaths(const ReceiverTracer& at, const PathTracer& tracer, const Transmitter& transmitter);

  std::size_t size() const { return ends_.size(); }

  // The sum of a and tau of all paths, so that nothing is left out by a compiler.
  double evaluate() const;

 private:
  LinkEnd<double> transmitter_;
  LinkEnd<double> receiver_;
  double wavelength_;
  // Those of all paths, one after the other.
  std::vector<Interaction> interactions_;
  std::vector<Facet<double>> facets_;
  std::vector<Plane<double>> planes_;
  std::vector<std::size_t> ends_;  // of each path in them
};

}  // namespace rayloc::bench
