// The conjugate product of antennas: what Widar2.0 makes of frames, whose phase and delay are new
// in each one but shared by all antennas [W2].
//
// The reference antenna is the one whose amplitude varies least. From the others the least
// amplitude in time, what stands still, is taken off, and to the reference much is added. What is
// left is mostly the moving path against the standing ones, exp(-j 2 pi v t / wavelength); its
// conjugate, the reference's moving path, is made weak. The reference against itself is real and
// has both senses alike.
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
