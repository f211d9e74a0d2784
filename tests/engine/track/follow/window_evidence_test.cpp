#include "engine/track/follow/window_evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rayloc::window_evidence_test {
namespace {

constexpr double kExponent = 0.3;
const Grid kGrid({0, 0, 0}, {0.4, 0.3, 2}, 1.0, 0.1);
const CellWindow kWindow{1, 1, 2, 2};
const MomentWeights kWeights{0.1, 0.8};

// A different value for each cell.
std::vector<double> values(double scale, double first) {
  std::vector<double> result;
  for (std::size_t cell = 0; cell < kGrid.size(); ++cell) {
    result.push_back(first + scale * std::sin(1.0 + 2.0 * static_cast<double>(cell)));
  }
  return result;
}

std::vector<double> tempered(const std::vector<double>& log_likelihood) {
  return tempered_in_window(
      log_likelihood, values(0.04, 0.08), kWindow, kGrid, kExponent, kWeights);
}

TEST(TemperedInWindow, CountsTheWeightOfTheWindowInIt) {
  const std::vector<double> before = values(20.0, -500.0);
  const std::vector<double> after = tempered(before);
  const std::size_t a = kWindow.cell(0, kGrid);
  const std::size_t b = kWindow.cell(3, kGrid);
  EXPECT_NEAR(
      kWeights.room * (after[a] - after[b]), kWeights.window * (before[a] - before[b]), 1e-9);
}

TEST(TemperedInWindow, LeavesTheOtherCells) {
  const std::vector<double> before = values(20.0, -500.0);
  const std::vector<double> after = tempered(before);
  for (std::size_t cell = 0; cell < kGrid.size(); ++cell) {
    if (!kWindow.number(cell, kGrid)) {
      EXPECT_EQ(after[cell], before[cell]) << cell;
    }
  }
}

// ln of the mean of the window's likelihoods, raised to `weight`.
double log_mean(const std::vector<double>& log_likelihood, double weight) {
  const std::vector<double> prior = values(0.04, 0.08);
  double sum = 0.0;
  double mass = 0.0;
  for (std::size_t n = 0; n < kWindow.size(); ++n) {
    const std::size_t cell = kWindow.cell(n, kGrid);
    sum += prior[cell] * std::exp(weight * kExponent * (log_likelihood[cell] + 500.0));
    mass += prior[cell];
  }
  return std::log(sum / mass);
}

TEST(TemperedInWindow, KeepsTheMeanOfTheWindow) {
  const std::vector<double> before = values(20.0, -500.0);
  EXPECT_NEAR(
      log_mean(tempered(before), kWeights.room), kWeights.room * log_mean(before, 1.0), 1e-9);
}

TEST(TemperedInWindow, KeepsAnImpossibleWindow) {
  std::vector<double> before = values(20.0, -500.0);
  for (std::size_t n = 0; n < kWindow.size(); ++n) {
    before[kWindow.cell(n, kGrid)] = -1e9;
  }
  EXPECT_EQ(tempered(before), before);
}

}  // namespace
}  // namespace rayloc::window_evidence_test
