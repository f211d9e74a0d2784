// What the surfaces of a room multiply the paths by that they reflect
// (RoomModel::surface_correction), on traced paths and on their derivatives.
#pragma once

#include <complex>
#include <span>

#include "engine/trace/path_derivatives.h"
#include "engine/trace/paths.h"

namespace rayloc {

// `correction` is of each surface of the scene; empty: 1. The amplitudes of `paths` and of their
// derivatives are multiplied, delays stay. REQUIRES: derivatives of these paths, or none.
void correct_paths(std::span<const std::complex<double>> correction, Paths& paths);
void correct_paths(std::span<const std::complex<double>> correction,
                   Paths& paths,
                   PathDerivatives& derivatives);

}  // namespace rayloc
