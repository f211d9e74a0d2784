// SampleModel: the expected array of a surveyed point at an access point, in the coordinates of a
// delay basis, its residual against the measured array, and the residual's derivatives.
//
// Measured and expected arrays are compared up to one complex factor and one delay per burst
// (METHODS B1): the residual is the part of the measured array, scaled to unit norm, that remains
// when the expected one and its derivative by delay are projected out. Its squared norm is
// 1 - |<h, h'>|^2 / (|h|^2 |h'|^2) at the best delay.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/calibrate/joint/traced_sample.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/likelihood/delay_basis.h"
#include "engine/observe/alignment.h"
#include "engine/trace/cfr_kernel.h"

namespace rayloc {

// A point in the space of the unknowns: changes relative to the traced state, and the offset of the
// device from its surveyed position.
struct ModelPoint {
  std::span<const double> change;  // of each unknown
  Vec3d survey;                    // [m]
};

// A measured array prepared for comparison with one traced sample.
struct MeasuredSample {
  Eigen::VectorXcd y;    // [antenna][coordinate], unit norm
  double origin = 0.0;   // [s], the rays' delay at which the basis starts
  double outside = 0.0;  // share of the measured power that no ray can explain
};

struct SampleResidual {
  Eigen::VectorXcd value;       // [antenna][coordinate]
  Eigen::MatrixXcd derivative;  // a column for each requested unknown
  Eigen::MatrixXcd by_survey;   // [.., 3]
  double unexplained() const { return value.squaredNorm(); }
};

class SampleModel {
 public:
  explicit SampleModel(const OfdmGrid& grid);

  // A model that weights every coordinate of the delay basis by the inverse of its usual residual:
  // diffuse power is concentrated at some delays. `left_over`: add_left_over() of a model without
  // weights.
  SampleModel weighed(const Eigen::MatrixXcd& left_over) const;

  // Adds the covariance of a sample's residual, of one antenna in coordinates, relative to its
  // total residual. `h` as for measured().
  Eigen::MatrixXcd nothing_left_over() const;
  void add_left_over(const TracedSample& sample,
                     const ModelPoint& at,
                     std::span<const std::complex<double>> h,
                     Eigen::MatrixXcd& sum) const;

  // `h`: measured, chain gains removed, [antenna][tone]; is aligned to the expected array at `at`.
  MeasuredSample measured(const TracedSample& sample,
                          const ModelPoint& at,
                          std::span<const std::complex<double>> h) const;

  // The expected array on the tones, [antenna][tone].
  std::vector<std::complex<double>> expected_tones(const TracedSample& sample,
                                                   const ModelPoint& at) const;

  // Without derivatives.
  double unexplained(const TracedSample& sample,
                     const MeasuredSample& measured,
                     const ModelPoint& at) const;
  // With derivatives by `unknowns`, which are in ascending order.
  SampleResidual residual(const TracedSample& sample,
                          const MeasuredSample& measured,
                          const ModelPoint& at,
                          std::span<const std::uint32_t> unknowns) const;

  // unexplained() along one unknown, at each of `values` instead of its own value.
  std::vector<double> scan(const TracedSample& sample,
                           const MeasuredSample& measured,
                           const ModelPoint& at,
                           std::uint32_t unknown,
                           std::span<const double> values) const;

  const Aligner& aligner() const { return aligner_; }

 private:
  Eigen::VectorXcd expected(const TracedSample& sample, double origin, const ModelPoint& at) const;
  // Adds the contribution of one ray.
  void add_ray(const std::complex<double>& phasor,
               double delay,
               Eigen::Ref<Eigen::VectorXcd> sum) const;
  Eigen::VectorXcd coordinates(std::span<const std::complex<double>> h, double delay) const;
  Eigen::VectorXcd by_delay(const Eigen::VectorXcd& array) const;
  void weigh(Eigen::Ref<Eigen::VectorXcd> array) const;
  double left_over(const Eigen::VectorXcd& expected, const Eigen::VectorXcd& y) const;

  OfdmGrid grid_;
  CfrKernel cfr_;
  DelayBasis basis_;
  Aligner aligner_;
  Eigen::MatrixXcd slope_;  // d/d delay of coordinates [1/s]
  bool weighed_ = false;
  Eigen::MatrixXcd weight_;  // of one antenna's coordinates; weighted model only
};

}  // namespace rayloc
