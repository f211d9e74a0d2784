// PathColumns: paths in the layout of the CFR kernel's input.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "engine/trace/cfr_kernel.h"

namespace rayloc::test {

struct PathColumns {
  std::vector<double> a_re;
  std::vector<double> a_im;
  std::vector<double> tau;  // [s]

  void add(const std::complex<double>& a, double delay) {
    a_re.push_back(a.real());
    a_im.push_back(a.imag());
    tau.push_back(delay);
  }
  PathArrays arrays() const { return {a_re, a_im, tau}; }
  std::size_t size() const { return tau.size(); }
};

}  // namespace rayloc::test
