// MotionSage: moving paths in a window of conjugate products by the SAGE algorithm [W2]: the rate
// of a path's length, its delay, and its phase from antenna to antenna.
//
//   product(m, k, t) = sum of a exp(j (psi (m - ref) - 2 pi (f_k - f_c) tau - 2 pi v t / lambda))
//
// References: [W2] as in conjugate_product.h.
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace rayloc {

struct MotionPath {
  double rate = 0.0;    // [m/s], positive: the length grows
  double delay = 0.0;   // [s], relative to static paths
  double psi = 0.0;     // [rad]
  double energy = 0.0;  // explained energy of the window
};

struct MotionSageOptions {
  std::size_t paths = 5;
  std::size_t psi_points = 72;  // on the circle
  double least_delay = -50e-9;  // [s]
  double most_delay = 150e-9;   // [s]
  double delay_step = 2e-9;     // [s]
  double most_rate = 3.0;       // [m/s]
  double rate_step = 0.05;      // [m/s]
  int rounds = 20;              // at most
};

class MotionSage {
 public:
  // tone_hz: from the centre of the channel; step_s: from instant to instant.
  MotionSage(std::vector<double> tone_hz,
             std::size_t antennas,
             std::size_t instants,
             double step_s,
             double wavelength,
             const MotionSageOptions& options = {});

  // In the order of detection. window: [antenna * tones + tone][instant]; the phase of a path is
  // relative to antenna `reference`.
  std::vector<MotionPath> paths(const Eigen::MatrixXcd& window, std::size_t reference) const;

  std::size_t instants() const { return static_cast<std::size_t>(rate_.cols()); }

 private:
  struct Index {
    Eigen::Index rate = 0;
    Eigen::Index delay = 0;
    Eigen::Index psi = 0;
    friend bool operator==(const Index&, const Index&) = default;
  };
  Eigen::VectorXcd over_channel(const Eigen::MatrixXcd& window,
                                const Eigen::VectorXcd& in_time) const;
  Index search(const Eigen::MatrixXcd& window,
               std::size_t reference,
               Index from,
               bool is_new) const;
  Eigen::VectorXcd channel_of(const Index& at, std::size_t reference) const;

  Eigen::Index antennas_;
  Eigen::MatrixXcd rate_;   // [rate][instant], steering
  Eigen::MatrixXcd delay_;  // [delay][tone]
  Eigen::VectorXd rates_;
  Eigen::VectorXd delays_;
  Eigen::VectorXd psis_;
  int rounds_;
  std::size_t paths_;
};

}  // namespace rayloc
