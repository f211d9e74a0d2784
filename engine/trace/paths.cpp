#include "engine/trace/paths.h"

#include "engine/trace/cfr_kernel.h"

namespace rayloc {

std::vector<std::complex<double>> Paths::cfr(const OfdmGrid& grid) const {
  std::vector<std::complex<double>> h(grid.size());
  cfr(grid, h);
  return h;
}

void Paths::cfr(const OfdmGrid& grid, std::span<std::complex<double>> out) const {
  std::vector<double> a_re;
  std::vector<double> a_im;
  std::vector<double> tau;
  for (std::vector<double>* column : {&a_re, &a_im, &tau}) {
    column->reserve(size());
  }
  for (const Path& path : paths_) {
    a_re.push_back(path.a.re);
    a_im.push_back(path.a.im);
    tau.push_back(path.tau);
  }
  CfrKernel(grid).forward({a_re, a_im, tau}, out);
}

}  // namespace rayloc
