// Correction factors of reflections at the surfaces of a room (RoomModel::surface_correction),
// applied to traced paths and to their derivatives.
#pragma once

#include <complex>
#include <span>

#include "engine/trace/interactions/interaction_kind.h"
#include "engine/trace/path_derivatives.h"
#include "engine/trace/paths.h"

namespace rayloc {

// True for the kinds of interaction that a surface's correction applies to.
bool is_corrected(InteractionKind kind);

// `amplitude` times the corrections of the surfaces of `path`, in order from the transmitter.
// `correction` has one factor for each surface of the scene; empty: 1.
std::complex<double> apply_surface_correction(std::span<const std::complex<double>> correction,
                                              const Path& path,
                                              std::complex<double> amplitude);

// Applies the corrections to the amplitudes of all `paths` and their derivatives; delays stay.
// REQUIRES: derivatives of these paths, or none.
void correct_paths(std::span<const std::complex<double>> correction, Paths& paths);
void correct_paths(std::span<const std::complex<double>> correction,
                   Paths& paths,
                   PathDerivatives& derivatives);

}  // namespace rayloc
