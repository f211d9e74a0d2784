// What the surfaces of a room multiply the paths by that they reflect
// (RoomModel::surface_correction), on traced paths and on their derivatives.
#pragma once

#include <complex>
#include <span>

#include "engine/trace/interactions/interaction_kind.h"
#include "engine/trace/path_derivatives.h"
#include "engine/trace/paths.h"

namespace rayloc {

// Whether a surface's correction is of such an interaction.
bool is_corrected(InteractionKind kind);

// `amplitude` times the corrections of the surfaces of `path`, one after another from the
// transmitter on. `correction` is of each surface of the scene; empty: 1.
std::complex<double> apply_surface_correction(std::span<const std::complex<double>> correction,
                                              const Path& path,
                                              std::complex<double> amplitude);

// The same of the amplitudes of all `paths` and of their derivatives; delays stay.
// REQUIRES: derivatives of these paths, or none.
void correct_paths(std::span<const std::complex<double>> correction, Paths& paths);
void correct_paths(std::span<const std::complex<double>> correction,
                   Paths& paths,
                   PathDerivatives& derivatives);

}  // namespace rayloc
