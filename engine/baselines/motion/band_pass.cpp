#include "engine/baselines/motion/band_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"

namespace rayloc {

// The poles of the low-pass prototype are moved to the band, then by the bilinear transform into
// the unit disc. Every section has a conjugate pair of them and zeros at both ends of the spectrum.
BandPass::BandPass(double low, double high, double rate) {
  RAYLOC_CHECK(0.0 < low && low < high && high < 0.5 * rate);
  using Complex = std::complex<double>;
  const double doubled = 2.0 * rate;
  const double w_low = doubled * std::tan(std::numbers::pi * low / rate);
  const double w_high = doubled * std::tan(std::numbers::pi * high / rate);
  const double width = w_high - w_low;
  const double centre = w_low * w_high;
  const auto order = static_cast<double>(sections_.size());
  std::size_t section = 0;
  Complex gain = 1.0;
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const double angle =
        std::numbers::pi * (2.0 * static_cast<double>(i) + order + 1.0) / (2.0 * order);
    const Complex half = 0.5 * width * std::polar(1.0, angle);
    const Complex root = std::sqrt(half * half - centre);
    for (const Complex& pole : {half + root, half - root}) {
      gain *= width * doubled / (doubled - pole) / std::sqrt(width * doubled);
      if (pole.imag() > 0.0) {  // the conjugates belong to the same sections
        const Complex z = (doubled + pole) / (doubled - pole);
        sections_.at(section++) = {{1.0, 0.0, -1.0}, {-2.0 * z.real(), std::norm(z)}};
      }
    }
  }
  RAYLOC_CHECK(section == sections_.size());
  for (double& b : sections_.front().b) {
    b *= gain.real();
  }
}

void BandPass::run(std::vector<std::complex<double>>& signal) const {
  std::complex<double> level = signal.front();  // input of a section in the steady state
  for (const Section& s : sections_) {
    const double at_rest = (s.b[0] + s.b[1] + s.b[2]) / (1.0 + s.a[0] + s.a[1]);
    std::complex<double> second = (s.b[2] - s.a[1] * at_rest) * level;
    std::complex<double> first = (s.b[1] - s.a[0] * at_rest) * level + second;
    level *= at_rest;
    for (std::complex<double>& x : signal) {
      const std::complex<double> y = s.b[0] * x + first;
      first = s.b[1] * x - s.a[0] * y + second;
      second = s.b[2] * x - s.a[1] * y;
      x = y;
    }
  }
}

std::vector<std::complex<double>> BandPass::filtered(
    std::span<const std::complex<double>> signal) const {
  RAYLOC_CHECK(signal.size() > kContinued);
  const std::size_t n = signal.size();
  std::vector<std::complex<double>> longer;
  longer.reserve(n + 2 * kContinued);
  for (std::size_t i = kContinued; i > 0; --i) {
    longer.push_back(2.0 * signal[0] - signal[i]);
  }
  longer.insert(longer.end(), signal.begin(), signal.end());
  for (std::size_t i = 1; i <= kContinued; ++i) {
    longer.push_back(2.0 * signal[n - 1] - signal[n - 1 - i]);
  }
  run(longer);
  std::reverse(longer.begin(), longer.end());
  run(longer);
  std::reverse(longer.begin(), longer.end());
  return {longer.begin() + kContinued, longer.end() - kContinued};
}

}  // namespace rayloc
