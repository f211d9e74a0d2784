#include "engine/paper/loss.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/check.h"

namespace rayloc::paper {
namespace {

using Value = std::complex<double>;

constexpr double kNothingAgrees = 2.0;  // the largest SMAPE

double sign(double x) { return static_cast<double>(x > 0.0) - static_cast<double>(x < 0.0); }

bool is_silent(std::span<const Value> h) {
  return std::all_of(h.begin(), h.end(), [](const Value& v) { return v == Value(); });
}

}  // namespace

double smape(std::span<const double> measured, std::span<const double> expected) {
  RAYLOC_CHECK(measured.size() == expected.size() && !measured.empty());
  double sum = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double scale = std::abs(measured[i]) + std::abs(expected[i]);
    sum += scale > 0.0 ? 2.0 * std::abs(measured[i] - expected[i]) / scale : 0.0;
  }
  return sum / static_cast<double>(measured.size());
}

std::vector<double> smape_gradient(std::span<const double> measured,
                                   std::span<const double> expected) {
  RAYLOC_CHECK(measured.size() == expected.size() && !measured.empty());
  std::vector<double> gradient(expected.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double scale = std::abs(measured[i]) + std::abs(expected[i]);
    const double off = expected[i] - measured[i];
    if (scale > 0.0) {
      gradient[i] = 2.0 * (sign(off) * scale - std::abs(off) * sign(expected[i])) /
                    (scale * scale * static_cast<double>(measured.size()));
    }
  }
  return gradient;
}

Loss::Loss(const OfdmGrid& grid, const SavitzkyGolayOptions& smoothing, double floor)
    : grid_(grid),
      delay_(grid, smoothing, floor),
      amplitude_(grid, smoothing, floor),
      aligner_(grid) {}

Loss::Measured Loss::measure(std::span<const Value> h, std::vector<double> line_of_sight) const {
  // The timing offset is removed as far as the line of sight determines it, so that smoothing and
  // slopes see a few ns instead of hundreds; the mean removes the rest (Delay).
  std::vector<Value> direct;
  for (const double delay : line_of_sight) {
    for (std::size_t k = 0; k < grid_.size(); ++k) {
      const double turns = grid_.frequency_hz(k) * delay;
      direct.push_back(std::polar(1.0, -2.0 * std::numbers::pi * (turns - std::floor(turns))));
    }
  }
  std::vector<Value> aligned(h.begin(), h.end());
  aligner_.apply(aligner_.align(direct, h), aligned);
  Measured result;
  result.anchor = delay_.anchor(aligned, std::move(line_of_sight));
  result.delay = delay_.of(aligned, result.anchor);
  result.amplitude = amplitude_.of(h);
  return result;
}

double Loss::value(LossKind kind, const Measured& measured, std::span<const Value> expected) const {
  if (is_silent(expected)) {
    return kNothingAgrees;
  }
  return kind == LossKind::kDelay ? smape(measured.delay, delay_.of(expected, measured.anchor))
                                  : smape(measured.amplitude, amplitude_.of(expected));
}

std::vector<Value> Loss::adjoint(LossKind kind,
                                 const Measured& measured,
                                 std::span<const Value> expected) const {
  if (is_silent(expected)) {
    return std::vector<Value>(expected.size());
  }
  if (kind == LossKind::kDelay) {
    const auto delay = delay_.of(expected, measured.anchor);
    return delay_.adjoint(expected, measured.anchor, smape_gradient(measured.delay, delay));
  }
  const auto amplitude = amplitude_.of(expected);
  return amplitude_.adjoint(expected, smape_gradient(measured.amplitude, amplitude));
}

}  // namespace rayloc::paper
