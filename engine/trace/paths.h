// Paths: all paths of one link, in canonical order: fewer interactions first, then by their surface
// numbers from the transmitter on.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"
#include "engine/trace/path.h"

namespace rayloc {

class Paths {
 public:
  Paths() = default;
  explicit Paths(std::vector<Path> paths) : paths_(std::move(paths)) {}

  std::size_t size() const { return paths_.size(); }
  bool empty() const { return paths_.empty(); }
  const Path& operator[](std::size_t i) const { return paths_[i]; }
  auto begin() const { return paths_.begin(); }
  auto end() const { return paths_.end(); }

  // Channel frequency response h(f_j) = sum a exp(-j 2 pi f_j tau) on the tones of the grid.
  // Materials, patterns and wavelength are those at the carrier.
  std::vector<std::complex<double>> cfr(const OfdmGrid& grid) const;
  // Writes the response to `out`. REQUIRES: out.size() == grid.size().
  void cfr(const OfdmGrid& grid, std::span<std::complex<double>> out) const;

 private:
  std::vector<Path> paths_;
};

}  // namespace rayloc
