// AntennaGainTable: the gain of an antenna, measured or computed on a grid of directions.
//
// As text, comma-separated, angles in degrees of the antenna's own frame (spherical.h), gains in
// dBi. The first line names the columns; its first cell may contain any text:
//
//   theta\phi,    0,   90,  180,  270
//           0, -3.0, -3.0, -3.0, -3.0
//          90,  2.1, -1.0, -9.5, -1.0
//         180, -4.0, -4.0, -4.0, -4.0
//
// theta runs from 0 to 180 and phi over one full turn, both in even steps; phi has any first value,
// does not repeat its first column, and has an even number of columns. Empty lines and those that
// begin with '#' are skipped; LF or CRLF, with or without a byte order mark.
//
// Between the samples the decibels follow bicubic splines (Catmull-Rom: through the samples, slope
// from the neighbours), periodic in phi and continued over the poles: continuous with its
// derivatives by theta and phi.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

class AntennaGainTable {
 public:
  // `name` denotes the file. Errors are kConfiguration: "NAME:LINE: what is
  // wrong, what to write".
  static Expected<AntennaGainTable> parse(std::string_view text, std::string name);

  const std::string& name() const { return name_; }

  struct Gain {
    double dbi = 0.0;
    double by_theta = 0.0;  // [dB/rad]
    double by_phi = 0.0;    // [dB/rad]
  };
  // REQUIRES: 0 <= theta <= pi; phi may be any finite angle. [rad]
  Gain at(double theta, double phi) const;

 private:
  AntennaGainTable() = default;

  std::size_t theta_count() const { return dbi_.size() / phi_count_; }
  // Sample in row `i`, at most one beyond the poles, and column `k`, any.
  double sample(std::ptrdiff_t i, std::ptrdiff_t k) const;

  std::string name_;
  std::size_t phi_count_ = 1;
  double first_phi_ = 0.0;   // [rad]
  std::vector<double> dbi_;  // [theta][phi], phi fastest
};

}  // namespace rayloc
