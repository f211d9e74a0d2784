#include "engine/em/scattering_lobe.h"

#include <numbers>

namespace rayloc {
namespace {

struct Polynomial {
  std::array<double, kLobeNodes + 1> value{};  // of each degree
  double slope = 0.0;                          // of the last
};

// Legendre's, |x| < 1.
Polynomial legendre_at(double x) {
  Polynomial p;
  p.value[0] = 1.0;
  p.value[1] = x;
  for (std::size_t k = 2; k < p.value.size(); ++k) {
    const auto order = static_cast<double>(k);
    p.value.at(k) =
        ((2.0 * order - 1.0) * x * p.value.at(k - 1) - (order - 1.0) * p.value.at(k - 2)) / order;
  }
  // A count: the degree of the last.
  constexpr auto kDegree = static_cast<double>(kLobeNodes);
  p.slope = kDegree * (x * p.value.back() - p.value.at(kLobeNodes - 1)) / (x * x - 1.0);
  return p;
}

LobeNodes make_nodes() {
  constexpr int kNewtonSteps = 20;  // from a guess of three digits: five are enough
  LobeNodes nodes;
  for (std::size_t i = 0; i < kLobeNodes; ++i) {
    double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) /
                        (static_cast<double>(kLobeNodes) + 0.5));
    for (int step = 0; step < kNewtonSteps; ++step) {
      const Polynomial p = legendre_at(x);
      x -= p.value.back() / p.slope;
    }
    const Polynomial p = legendre_at(x);
    const double weight = 2.0 / ((1.0 - x * x) * p.slope * p.slope);
    nodes.cosine.at(i) = 0.5 * (1.0 + x);
    nodes.weight.at(i) = 0.5 * weight;
    for (std::size_t k = 0; k < kLobeNodes; ++k) {
      nodes.legendre.at(k).at(i) = (static_cast<double>(k) + 0.5) * weight * p.value.at(k);
    }
  }
  return nodes;
}

}  // namespace

const LobeNodes& lobe_nodes() {
  // The Gauss-Legendre rule: numbers.
  static const LobeNodes kNodes = make_nodes();
  return kNodes;
}

}  // namespace rayloc
