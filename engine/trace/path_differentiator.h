// PathDifferentiator: derivatives of the paths of one link by dual numbers, a few parameters at a
// time; each path is differentiated only by the parameters that it depends on.
#pragma once

#include <span>

#include "engine/base/expected.h"
#include "engine/trace/parameter.h"
#include "engine/trace/path_derivatives.h"
#include "engine/trace/paths.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

// An Error when a parameter does not exist in this scene, or has no derivative: the thickness of a
// half space, the lobe of a smooth material.
Expected<void> check_parameter(const TraceContext& context, const Parameter& parameter);

class PathDifferentiator {
 public:
  // The arguments must outlive the differentiator.
  PathDifferentiator(const TraceContext& context,
                     const Transmitter& transmitter,
                     const Receiver& receiver)
      : context_(context), transmitter_(transmitter), receiver_(receiver) {}

  // An Error as in check_parameter().
  Expected<PathDerivatives> differentiate(const Paths& paths,
                                          std::span<const Parameter> parameters) const;

 private:
  template <int N>
  PathDerivatives run(const Paths& paths, std::span<const Parameter> parameters) const;
  bool depends(const Path& path, const Parameter& parameter) const;

  const TraceContext& context_;
  const Transmitter& transmitter_;
  const Receiver& receiver_;
};

}  // namespace rayloc
