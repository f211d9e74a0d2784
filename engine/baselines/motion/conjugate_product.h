// The conjugate product of antennas: the preprocessing of Widar2.0 for frames, whose phase and
// delay change from frame to frame but are shared by all antennas [W2].
//
// The reference antenna is the one whose amplitude varies least. The least amplitude over time,
// that of static paths, is subtracted from the other antennas, and a large constant is added to the
// reference. The result is mostly the moving path against the static ones, exp(-j 2 pi v t /
// wavelength); its conjugate, from the reference's moving path, becomes weak. The product of the
// reference with itself is real and contains both signs alike.
//
// References: [W2] K. Qian et al., Widar2.0, ACM MobiSys 2018.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace rayloc {

struct ConjugateProduct {
  std::size_t reference = 0;  // antenna
  Eigen::MatrixXcd product;   // [antenna * tones + tone][time]
};

// h: [antenna * tones + tone][time], chain gains removed. REQUIRES: antennas > 1, an instant.
ConjugateProduct conjugate_product(const Eigen::MatrixXcd& h, std::size_t antennas);

}  // namespace rayloc
