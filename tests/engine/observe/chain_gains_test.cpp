#include "engine/observe/chain_gains.h"

#include <gtest/gtest.h>

#include <random>

namespace rayloc::chain_gains_test {
namespace {

using Value = std::complex<double>;

constexpr std::size_t kRxChains = 3;
constexpr std::size_t kTones = 4;

std::vector<Value> random_values(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Value> result;
  for (std::size_t i = 0; i < count; ++i) {
    const double re = normal(random);
    const double im = normal(random);
    result.emplace_back(re, im);
  }
  return result;
}

ChainGains example() {
  return {{5.19e9, 312'500.0, {-2, -1, 1, 2}}, {2, 0, 3}, random_values(kRxChains * kTones, 1), {}};
}

TEST(ChainGains, AreRemovedFromReportedChannels) {
  const ChainGains gains = example();
  const auto field = random_values(kRxChains * kTones, 2);
  auto h = field;
  for (std::size_t i = 0; i < h.size(); ++i) {
    h[i] *= gains.gain[i];
  }
  remove_gains(gains, h);
  for (std::size_t i = 0; i < h.size(); ++i) {
    EXPECT_NEAR(std::abs(h[i] - field[i]), 0.0, 1e-12);
  }
}

TEST(ChainGains, LeaveNothingOfADeadChain) {
  ChainGains gains = example();
  gains.gain[5] = 0.0;
  auto h = random_values(kRxChains * kTones, 2);
  remove_gains(gains, h);
  EXPECT_EQ(h[5], Value());
  EXPECT_NE(h[4], Value());
}

TEST(ChainGains, ACouplingGivesACoreItsShareOfAnother) {
  ChainGains gains = example();
  gains.coupling = {1.0, {0.0, 0.1}, 0.0, 0.0, 1.0, 0.0, 0.2, 0.0, 1.0};
  const auto field = random_values(kRxChains * kTones, 3);
  auto h = field;
  apply_coupling(gains, h);
  for (std::size_t k = 0; k < kTones; ++k) {
    const auto at = [&](std::size_t rx_chain) { return field[rx_chain * kTones + k]; };
    EXPECT_NEAR(std::abs(h[k] - (at(0) + Value(0.0, 0.1) * at(1))), 0.0, 1e-12);
    EXPECT_EQ(h[kTones + k], at(1));
    EXPECT_NEAR(std::abs(h[2 * kTones + k] - (at(2) + 0.2 * at(0))), 0.0, 1e-12);
  }
}

TEST(ChainGains, ACouplingIsUndoneBehindTheGains) {
  ChainGains gains = example();
  gains.coupling = random_values(kRxChains * kRxChains, 4);
  for (Value& value : gains.coupling) {
    value *= 0.1;
  }
  for (std::size_t rx_chain = 0; rx_chain < kRxChains; ++rx_chain) {
    gains.coupling[rx_chain * kRxChains + rx_chain] = 1.0;
  }
  const auto field = random_values(kRxChains * kTones, 5);
  auto h = field;
  apply_coupling(gains, h);
  for (std::size_t i = 0; i < h.size(); ++i) {
    h[i] *= gains.gain[i];
  }
  remove_gains(gains, h);
  for (std::size_t i = 0; i < h.size(); ++i) {
    EXPECT_NEAR(std::abs(h[i] - field[i]), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace rayloc::chain_gains_test
