// sanitised: removes the phase and the timing offset that all antennas of a frame share [SF,
// algorithm 1]. Phases between antennas are preserved; delays become relative.
//
// References: [SF] M. Kotaru et al., SpotFi, SIGCOMM 2015.
#pragma once

#include <Eigen/Core>

namespace rayloc {

// `h`: [antenna][tone], on a comb (ToneComb). Subtracts the line that fits the unwrapped phases of
// all antennas in least squares. A delay common to all antennas is removed before the phases are
// unwrapped, so the result does not depend on its value.
Eigen::MatrixXcd sanitised(const Eigen::MatrixXcd& h);

}  // namespace rayloc
