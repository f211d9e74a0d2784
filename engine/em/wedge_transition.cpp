#include "engine/em/wedge_transition.h"

#include <cmath>
#include <numbers>

#include "engine/em/cylinder_window.h"

namespace rayloc {
namespace {

using C = Complex<double>;

// Above this the asymptotic series has all digits of a double; below, the knife edge loses none.
constexpr double kSeriesBegin = 6.0;
constexpr double kMinTransitionTerm = 1e-17;  // of a term of the series
constexpr int kMaxTerms = 36;                 // the smallest term at kSeriesBegin

// The sum over m >= 1 of (2 m - 1)!! (j / (2 w^2))^m.
C series_excess(double w) {
  const double step = 1.0 / (2.0 * w * w);
  C term{0.0, step};
  C sum = term;
  for (int m = 2; m < kMaxTerms && abs2(term) > kMinTransitionTerm * kMinTransitionTerm; ++m) {
    term = C{0.0, (2.0 * m - 1.0) * step} * term;
    sum = sum + term;
  }
  return sum;
}

}  // namespace

WedgeTransition<double> wedge_transition(double w) {
  if (w > kSeriesBegin) {
    const C excess = series_excess(w);
    return {C{1.0 / w, 0.0} * (C{1.0, 0.0} + excess), excess};
  }
  // The integral is sqrt(pi) exp(-j pi / 4) times the knife-edge field sqrt(2 / pi) w below it.
  const double phase = w * w + std::numbers::pi / 4.0;
  const double size = 2.0 / std::numbers::inv_sqrtpi;
  const C value = C{size * std::cos(phase), size * std::sin(phase)} *
                  knife_edge(-std::sqrt(2.0 / std::numbers::pi) * w);
  return {value, C{w, 0.0} * value - C{1.0, 0.0}};
}

}  // namespace rayloc
