#include "engine/room/surface_correction.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace rayloc {
namespace {

Complex<double> factor_of(const Path& path, std::span<const std::complex<double>> correction) {
  std::complex<double> factor = 1.0;
  for (const Interaction& interaction : path.interactions) {
    if (interaction.kind == InteractionKind::kReflection) {
      factor *= correction[interaction.surface];
    }
  }
  return {factor.real(), factor.imag()};
}

}  // namespace

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
