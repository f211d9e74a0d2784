#include "engine/room/surface_correction.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "engine/trace/interactions/interaction.h"

namespace rayloc {
namespace {

// The correction describes how a surface reflects; waves that pass through it or past it keep the
// coefficients of the material.
struct IsCorrected {
  constexpr bool operator()(interactions::Reflection /*met*/) const { return true; }
  constexpr bool operator()(interactions::Transmission /*met*/) const { return false; }
  constexpr bool operator()(interactions::Shadowing /*met*/) const { return false; }
  constexpr bool operator()(interactions::Diffraction /*met*/) const { return false; }
};

Complex<double> factor_of(const Path& path, std::span<const std::complex<double>> correction) {
  const std::complex<double> factor = apply_surface_correction(correction, path, 1.0);
  return {factor.real(), factor.imag()};
}

}  // namespace

bool is_corrected(InteractionKind kind) { return visit_interaction(kind, IsCorrected{}); }

std::complex<double> apply_surface_correction(std::span<const std::complex<double>> correction,
                                              const Path& path,
                                              std::complex<double> amplitude) {
  if (correction.empty()) {
    return amplitude;
  }
  for (const Interaction& interaction : path.interactions) {
    if (is_corrected(interaction.kind)) {
      amplitude *= correction[interaction.surface];
    }
  }
  return amplitude;
}

void correct_paths(std::span<const std::complex<double>> correction, Paths& paths) {
  if (correction.empty()) {
    return;
  }
  std::vector<Path> changed(paths.begin(), paths.end());
  for (Path& path : changed) {
    path.a = factor_of(path, correction) * path.a;
  }
  paths = Paths(std::move(changed));
}

void correct_paths(std::span<const std::complex<double>> correction,
                   Paths& paths,
                   PathDerivatives& derivatives) {
  if (correction.empty()) {
    return;
  }
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const Complex<double> factor = factor_of(paths[i], correction);
    for (std::size_t j = 0; j < derivatives.parameter_count(); ++j) {
      derivatives.at(i, j).a = factor * derivatives.at(i, j).a;
    }
  }
  correct_paths(correction, paths);
}

}  // namespace rayloc
