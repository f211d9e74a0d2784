// ArrayTracer: the paths from a device to every element of a receiving array.
//
// Tracing element by element is exact and the default. In the plane-wave mode the paths to the
// array's origin serve all elements: the delay to an element at offset o differs by -u.o / c, with
// u the direction of arrival. That is a third of the work for three elements, and wrong by about
// |o|^2 / (2 c d) for a path of length d (0.1 mm of path at 4 cm and 8 m) and at shadow edges,
// where elements see different paths.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/scene/antenna_array.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {

enum class ArrayMode : std::uint8_t { kElementByElement, kPlaneWave };

class ArrayTracer {
 public:
  ArrayTracer(const PathTracer& tracer,
              const AntennaArray& array,
              ArrayMode mode = ArrayMode::kElementByElement);

  std::size_t element_count() const { return array_.element_offset.size(); }
  const AntennaArray& array() const { return array_; }

  // Paths to each element.
  std::vector<Paths> trace(const Transmitter& transmitter) const;

  // Derivatives for each element; parameters of the receiver are those of the array, which moves
  // and turns as one (Parameter::receiver_array_turn). An Error as in
  // ReceiverTracer::differentiate, and in the plane-wave mode, which has no derivatives here.
  Expected<std::vector<PathDerivatives>> differentiate(const Transmitter& transmitter,
                                                       std::span<const Paths> paths,
                                                       std::span<const Parameter> parameters) const;

 private:
  AntennaArray array_;
  ArrayMode mode_;
  std::vector<ReceiverTracer> tracers_;  // one per element, or one for the origin
};

// [element][tone], tones fastest.
std::vector<std::complex<double>> array_csi(std::span<const Paths> paths, const OfdmGrid& grid);

// Derivatives of a real loss of array_csi() by every parameter; `csi_adjoint` as in
// PathDerivatives::loss_gradient, [element][tone].
std::vector<double> array_loss_gradient(std::span<const PathDerivatives> derivatives,
                                        std::span<const Paths> paths,
                                        const OfdmGrid& grid,
                                        std::span<const std::complex<double>> csi_adjoint);

}  // namespace rayloc
