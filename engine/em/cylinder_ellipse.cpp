// The elliptic CylinderSection: waves of the source, transition matrix, waves of the observer.
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/em/cylinder_bessel.h"
#include "engine/em/cylinder_modes.h"
#include "engine/em/cylinder_section.h"
#include "engine/em/cylinder_table.h"
#include "engine/em/cylinder_tmatrix.h"

namespace rayloc {
namespace {

using C = Complex<double>;

// Step between samples, in k_t times the larger semi-axis.
constexpr double kStep = 0.4;
// A flat body needs a few more orders than a round one of the same length.
constexpr std::size_t kMoreOrders = 8;
// The transition matrix is refused when its error is larger.
constexpr double kLargestAsymmetry = 1e-3;

constexpr std::size_t kSymmetryCount = kSymmetries.size();  // a count, of cylinder_tmatrix.h

// Index of symmetry.across() in kSymmetries.
constexpr std::size_t across(std::size_t symmetry) { return (symmetry + 2) % kSymmetryCount; }

void append(const Eigen::MatrixXcd& matrix, std::vector<C>& values) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) {
    values.push_back({matrix.data()[i].real(), matrix.data()[i].imag()});
  }
}

// Outgoing waves of one symmetry at a position, and their derivatives by the position.
struct Waves {
  Eigen::VectorXcd value, by_distance, by_azimuth;
};

std::array<Waves, kSymmetryCount> waves_at(double distance, double azimuth, std::size_t count) {
  std::vector<C> hankel(2 * count + 2);
  hankel_orders(distance, hankel);
  const auto size = static_cast<Eigen::Index>(count);
  std::array<Waves, kSymmetryCount> waves;
  for (std::size_t s = 0; s < kSymmetryCount; ++s) {
    waves[s] = {Eigen::VectorXcd(size), Eigen::VectorXcd(size), Eigen::VectorXcd(size)};
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t n = kSymmetries[s].order(k);
      const Angular a = angular(kSymmetries[s], n, azimuth);
      const double norm = n == 0 ? 1.0 : std::sqrt(2.0);
      const std::complex<double> h{norm * hankel[n].re, norm * hankel[n].im};
      const std::complex<double> next{norm * hankel[n + 1].re, norm * hankel[n + 1].im};
      const auto i = static_cast<Eigen::Index>(k);
      waves[s].value[i] = a.value * h;
      waves[s].by_distance[i] = a.value * (static_cast<double>(n) / distance * h - next);
      waves[s].by_azimuth[i] = a.slope * h;
    }
  }
  return waves;
}

// The transition matrices at one elevation; nothing when double precision does not suffice.
std::vector<C> coefficients(const std::array<double, 2>& k_semi_axes,
                            const C& relative_permittivity,
                            double cos_elevation,
                            std::size_t orders) {
  std::vector<C> values;
  for (const TransitionBlock& block :
       elliptic_transition(k_semi_axes, relative_permittivity, cos_elevation, orders)) {
    if (!(block.asymmetry < kLargestAsymmetry)) {
      return {};
    }
    append(block.vv, values);
    append(block.hh, values);
    append(block.vh, values);
  }
  return values;
}

// One sample per elevation; nothing when one is missing.
std::vector<std::vector<C>> sample(const std::array<double, 2>& k_semi_axes,
                                   const C& relative_permittivity,
                                   std::size_t orders) {
  const double longer = std::max(k_semi_axes[0], k_semi_axes[1]);
  const std::size_t count =
      kMinTableSamples + static_cast<std::size_t>((1.0 - kLowestCosine) * longer / kStep);
  std::vector<std::vector<C>> samples(count);
  // Zero elevation is the hardest case, so it detects an unsolvable body at once.
  samples.back() = coefficients(k_semi_axes, relative_permittivity, 1.0, orders);
  if (samples.back().empty()) {
    return {};
  }
  parallel_for(count - 1, 1, [&](std::size_t i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    const double cosine = kLowestCosine + share * (1.0 - kLowestCosine);
    samples[i] = coefficients(k_semi_axes, relative_permittivity, cosine, orders);
  });
  const bool complete = std::none_of(
      samples.begin(), samples.end(), [](const std::vector<C>& values) { return values.empty(); });
  return complete ? samples : std::vector<std::vector<C>>{};
}

class EllipticSection final : public CylinderSection {
 public:
  EllipticSection(std::size_t orders, std::vector<std::vector<C>> samples)
      : orders_(orders), table_(kLowestCosine, std::move(samples)) {}

 private:
  SectionResponse compute(const SectionRays& rays, bool slopes) const override {
    const auto in = waves_at(rays.kt_rho_in, rays.phi_in, orders_);
    const auto out = waves_at(rays.kt_rho_out, rays.phi_out, orders_);
    const ElevationTable::Place place = table_.at(rays.cos_elevation);
    const std::size_t size = orders_ * orders_;
    SectionResponse sum;
    for (std::size_t s = 0; s < kSymmetryCount; ++s) {
      const std::size_t h = across(s);
      const Matrices vv = read(place, 3 * s * size, slopes);
      const Matrices hh = read(place, (3 * s + 1) * size, slopes);
      const Matrices vh = read(place, (3 * s + 2) * size, slopes);
      add(sum, kVv, vv, in[s], out[s]);
      add(sum, kHh, hh, in[h], out[h]);
      add(sum, kVh, vh, in[h], out[s]);
      add(sum, kHv, {vh.value.transpose(), vh.slope.transpose()}, in[s], out[h]);
    }
    return sum;
  }

  struct Matrices {
    Eigen::MatrixXcd value;
    Eigen::MatrixXcd slope;  // by the cosine of the elevation; empty when not requested
  };

  Matrices read(const ElevationTable::Place& place, std::size_t first, bool slopes) const {
    const std::size_t size = orders_ * orders_;
    std::vector<C> values(size);
    std::vector<C> by_cosine(slopes ? size : 0);
    ElevationTable::read(place, first, values, by_cosine);
    return {matrix(values), matrix(by_cosine)};
  }

  Eigen::MatrixXcd matrix(const std::vector<C>& values) const {
    const auto n = values.empty() ? 0 : static_cast<Eigen::Index>(orders_);
    Eigen::MatrixXcd matrix(n, n);
    std::transform(values.begin(), values.end(), matrix.data(), [](const C& z) {
      return std::complex<double>(z.re, z.im);
    });
    return matrix;
  }

  static void add(SectionResponse& sum,
                  std::size_t part,
                  const Matrices& matrices,
                  const Waves& in,
                  const Waves& out) {
    const auto product = [](const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
      const std::complex<double> z = a.cwiseProduct(b).sum();
      return C{z.real(), z.imag()};
    };
    const auto add_to = [](C& to, const C& z) { to = to + z; };
    const Eigen::VectorXcd forth = matrices.value * in.value;
    add_to(sum.value[part], product(out.value, forth));
    if (matrices.slope.size() > 0) {
      const Eigen::VectorXcd back = matrices.value.transpose() * out.value;
      add_to(sum.slope[0][part], product(back, in.by_distance));
      add_to(sum.slope[1][part], product(out.by_distance, forth));
      add_to(sum.slope[2][part], product(back, in.by_azimuth));
      add_to(sum.slope[3][part], product(out.by_azimuth, forth));
      add_to(sum.slope[4][part], product(out.value, matrices.slope * in.value));
    }
  }

  std::size_t orders_;  // of each symmetry
  ElevationTable table_;
};

}  // namespace

Expected<std::unique_ptr<const CylinderSection>> make_elliptic_section(
    const std::array<double, 2>& k_semi_axes, const Complex<double>& relative_permittivity) {
  const double longer = std::max(k_semi_axes[0], k_semi_axes[1]);
  const std::size_t orders = (cylinder_order_count(longer) + kMoreOrders) / 2;
  auto samples = sample(k_semi_axes, relative_permittivity, orders);
  if (samples.empty()) {
    return bad_input(
        "this body cannot be computed: too flat for its size, with too little loss for its "
        "permittivity; make the semi-axes equal or the conductivity larger");
  }
  return std::make_unique<const EllipticSection>(orders, std::move(samples));
}

}  // namespace rayloc
