#include "engine/chains/chain_evidence.h"
#include "engine/grid/grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "engine/chains/cell_belief.h"
#include "engine/localize/localizer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::chain_evidence_test {
namespace {

std::shared_ptr<const Localizer> localizer() {
  static const std::shared_ptr<const Localizer> kLocalizer = [] {
    RoomModel room = test::make_room();
    room.access_points.resize(1);
    auto made = Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {});
    return std::make_shared<const Localizer>(*std::move(made));
  }();
  return kLocalizer;
}

// The share of the cells that are likelier than the cell of the place.
double share_above(const std::vector<double>& of_cell, const Vec3d& place) {
  const Grid& grid = localizer()->grid();
  std::size_t nearest = 0;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const auto away = [&](std::size_t one) {
      return std::hypot(grid.centre(one).x - place.x, grid.centre(one).y - place.y);
    };
    nearest = away(cell) < away(nearest) ? cell : nearest;
  }
  const auto above = std::count_if(
      of_cell.begin(), of_cell.end(), [&](double value) { return value > of_cell[nearest]; });
  return static_cast<double>(above) / static_cast<double>(of_cell.size());
}

TEST(ChainEvidence, LocatesWithUnknownChains) {
  const double exponent = localizer()->room().likelihood_exponent;
  double whatever = 0.0;
  double accepted = 0.0;
  constexpr int kPlaces = 12;
  for (int i = 0; i < kPlaces; ++i) {
    const Vec3d place{-1.1 + 0.19 * i, 0.8 - 0.13 * i, 1.2};
    auto frames = test::frames_at(localizer()->room(), place, {4, 30.0, 5U + unsigned(i)});
    // The second chain has rotated by half a turn.
    const std::uint8_t rx_chain = localizer()->room().access_points[0].rx_chains[1];
    for (CsiFrame& frame : frames) {
      for (std::size_t row = 0; row < frame.rx_chains.size(); ++row) {
        for (std::complex<float>& value : frame.csi.row(row, 0)) {
          value *= frame.rx_chains[row] == rx_chain ? -1.0F : 1.0F;
        }
      }
    }
    const RoomObservation received = localizer()->receive(frames);
    ASSERT_EQ(received.arrays.size(), 1U);
    const ArrayObservation& array = received.arrays.front();
    const RotationGrid grid(array.map->antennas());
    const std::vector<double> any(grid.size(), 1.0 / static_cast<double>(grid.size()));
    std::vector<double> as_calibrated(grid.size());
    as_calibrated[0] = 1.0;
    whatever += share_above(
        places_for_any_rotation(*array.map, array.observed, grid, exponent, any), place);
    accepted += share_above(
        places_for_any_rotation(*array.map, array.observed, grid, exponent, as_calibrated), place);
  }
  // Chance is one half. Wrong gains of the chains are worse than unknown gains.
  EXPECT_LT(whatever / kPlaces, 0.35);
  EXPECT_LT(whatever, accepted);
}

TEST(CellBelief, APossiblyFaultyAccessPointExcludesNoCell) {
  CellBelief belief(4);
  belief.receive(std::vector<double>{50.0, 0.0, 0.0, 0.0}, 0.1);
  belief.receive(std::vector<double>{0.0, 1.0, 1.0, 1.0}, 0.1);
  const std::vector<double> log_probability = belief.log_probability();
  double sum = 0.0;
  for (const double one : log_probability) {
    sum += std::exp(one);
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_EQ(std::max_element(log_probability.begin(), log_probability.end()),
            log_probability.begin());
  EXPECT_GT(std::exp(log_probability[3]), 0.02);  // of the first alone: 0.025
}

}  // namespace
}  // namespace rayloc::chain_evidence_test
