// sanitised: an array without what all antennas of a frame share: a phase and a timing offset [SF,
// algorithm 1]. Phases between antennas stay; delays become relative.
//
// References: [SF] M. Kotaru et al., SpotFi, SIGCOMM 2015.
#pragma once

#include <Eigen/Core>

namespace rayloc {

// `h`: [antenna][tone], on a comb (ToneComb). The line that fits the unwrapped phases of all
// antennas in least squares is taken off. A delay that all antennas have in common is undone before
// the phases are unwrapped, so the result does not depend on it, whatever it is.
Eigen::MatrixXcd sanitised(const Eigen::MatrixXcd& h);

}  // namespace rayloc
