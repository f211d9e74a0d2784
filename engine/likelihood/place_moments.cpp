#include "engine/likelihood/place_moments.h"

#include <cmath>

#include "engine/likelihood/gaussian/covariance_factor.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;
using Eigen::Index;

// obstructed: mu without the line of sight; size 0: there is no line of sight.
PlaceModel factorised_model(const Eigen::MatrixXcd& sigma,
                            const Eigen::VectorXcd& mu,
                            const Eigen::VectorXcd& obstructed,
                            double noise) {
  const CovarianceFactor factor(sigma);
  const Eigen::MatrixXcd& whitener = factor.whitener();
  const Eigen::VectorXcd mean = whitener * mu;
  PlaceModel place{factor.gaussian()};
  place.mean.reserve(static_cast<std::size_t>(mean.size() + obstructed.size()));
  for (const Value& v : mean) {
    place.mean.emplace_back(v);
  }
  const auto powers_of = [&](const Eigen::VectorXcd& whitened) {
    return PlaceModel::Powers{static_cast<float>(whitened.squaredNorm()),
                              static_cast<float>((whitener.adjoint() * whitened).squaredNorm())};
  };
  place.open = powers_of(mean);
  if (obstructed.size() > 0) {
    const Eigen::VectorXcd without = whitener * obstructed;
    for (const Value& v : without) {
      place.mean.emplace_back(v);
    }
    place.obstructed = powers_of(without);
  }
  place.log_determinant = static_cast<double>(static_cast<float>(place.log_determinant));
  place.noise = static_cast<float>(noise);
  place.reachable = true;
  return place;
}

// Adds the untraced power to the lower triangle: `diffuse` times the covariance R of one antenna,
// and `noise` in total.
void add_rest(double diffuse,
              double noise,
              const std::vector<Value>& covariance,
              Eigen::MatrixXcd& sigma) {
  const auto q = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(covariance.size()))));
  for (Index m = 0; m < sigma.rows(); m += q) {
    for (Index i = 0; i < q; ++i) {
      for (Index j = 0; j <= i; ++j) {
        sigma(m + i, m + j) += diffuse * covariance[static_cast<std::size_t>(i * q + j)];
      }
      sigma(m + i, m + i) += noise / static_cast<double>(sigma.rows());
    }
  }
}

}  // namespace

PlaceModel PlaceMoments::factorised(std::size_t antennas,
                                    const std::vector<Value>& covariance,
                                    double noise) const {
  Eigen::MatrixXcd all = sigma;
  add_rest(diffuse / static_cast<double>(antennas), noise, covariance, all);
  return factorised_model(
      all,
      mean.all,
      mean.direct.size() > 0 ? Eigen::VectorXcd(mean.all - mean.direct) : mean.direct,
      noise);
}

Eigen::MatrixXcd PlaceMoments::covariance(std::size_t antennas,
                                          const std::vector<Value>& covariance) const {
  Eigen::MatrixXcd all = sigma;
  add_rest(diffuse / static_cast<double>(antennas), 0.0, covariance, all);
  return all.selfadjointView<Eigen::Lower>();
}

}  // namespace rayloc
