// Dual numbers: ceres::Jet<double, N>, a value with its derivatives by N parameters.
//
// Most code does not depend on this, being written in a scalar T. This file is for functions of one
// variable whose value and slope are computed by other means.
#pragma once

#include <ceres/jet.h>

namespace rayloc {

inline double value_of(double x) { return x; }
template <int N>
double value_of(const ceres::Jet<double, N>& x) {
  return x.a;
}

// f(x), given f and df/dx at the value of x.
inline double composed(double /*x*/, double f, double /*slope*/) { return f; }
template <int N>
ceres::Jet<double, N> composed(const ceres::Jet<double, N>& x, double f, double slope) {
  return ceres::Jet<double, N>(f, slope * x.v);
}

}  // namespace rayloc
