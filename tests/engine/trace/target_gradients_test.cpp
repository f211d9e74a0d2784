// Derivatives of a loss of the channel by the place of a body, against central differences of all
// pairs past it, found anew at the body's new place.
//
// Prints a row of the table of engine/studies/2026-11-derivatives.md: RAYLOC_PRINT_GRADIENTS=1
// engine_gradients_test
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "engine/trace/scattering/scattering.h"
#include "tests/support/traced_link.h"

namespace rayloc::target_gradients_test {
namespace {

using test::TracedLink;

constexpr double kTolerance = 1e-6;  // relative
constexpr double kStep = 2e-5;       // [m]
constexpr TargetPosition kReferenceShift{0.02, -0.013};

// In the line of sight, at the edge of its shadow, aside of it, near the device, near a wall.
const std::map<std::string, std::array<TargetPosition, 5>> kPlaces{
    {"box", {{{-1.2, 0.51}, {-1.3, 0.8}, {0.5, 1.6}, {2.2, -1.2}, {-4.1, -4.2}}}},
    {"meeting_room", {{{-0.6, 1.11}, {-0.5, 0.85}, {-0.2, 0.2}, {0.8, 0.7}, {1.3, -1.0}}}},
    {"corridor", {{{6.1, 0.65}, {6.2, 0.4}, {7.7, -0.3}, {8.7, 0.5}, {4.4, -0.5}}}}};

// All links past one body, and the channel of the room without it.
class TargetLinks {
 public:
  TargetLinks(const TracedLink& link, const TargetBody& body)
      : soft_(link.options().softness > 0.0), grid_(link.grid()) {
    ScatteringOptions options;
    options.trace = link.options();
    options.negligible = 0.0;  // pairs must not come and go with their size
    const auto tracer = TargetTracer::create(link.shared_scene(), body, options);
    for (const Transmitter& transmitter : link.transmitters()) {
      for (TargetLink& past : tracer.value().links(transmitter, link.receivers())) {
        links_.push_back(std::move(past));
      }
    }
    empty_ = link.csi();
  }

  struct Channel {
    test::Csi h;
    std::vector<std::uint32_t> pairs;  // the surfaces of each, of each link
  };
  Channel at(const TargetPosition& position) const {
    Channel channel{empty_, {}};
    std::size_t tone = 0;
    for (const TargetLink& link : links_) {
      const Paths paths = link.trace(position).value();
      for (const std::complex<double>& value : paths.cfr(grid_)) {
        channel.h[tone++] += value;
      }
      for (const Path& path : paths) {
        for (const Interaction& interaction : path.interactions) {
          channel.pairs.push_back(interaction.surface);
        }
        channel.pairs.push_back(kNoSurface);
      }
    }
    return channel;
  }

  bool soft() const { return soft_; }
  // By x and y, of a loss L with dL = Re sum conj(g) dh.
  std::array<double, 2> gradient(const TargetPosition& position, const test::Csi& g) const {
    std::array<double, 2> sum{};
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const TargetPaths traced = links_[i].differentiate(position).value();
      const std::vector<double> part = traced.by_position.loss_gradient(
          traced.paths, grid_, std::span(g).subspan(i * grid_.size(), grid_.size()));
      sum[0] += part[0];
      sum[1] += part[1];
    }
    return sum;
  }

 private:
  bool soft_;
  OfdmGrid grid_;
  std::vector<TargetLink> links_;
  test::Csi empty_;
};

TargetPosition moved(const TargetPosition& from, std::size_t axis, double by) {
  return {from.x + (axis == 0 ? by : 0.0), from.y + (axis == 1 ? by : 0.0)};
}

// The derivative of D = sum |h - reference|^2: five-point, and nothing when a pair appears or
// vanishes at a hard edge.
std::optional<double> difference(const TargetLinks& links,
                                 const TargetPosition& position,
                                 std::size_t axis,
                                 const test::Csi& reference) {
  constexpr std::array<double, 4> kSteps{-2, -1, 1, 2};
  constexpr std::array<double, 4> kWeights{1, -8, 8, -1};
  const auto pairs = links.at(position).pairs;
  double sum = 0.0;
  for (std::size_t i = 0; i < kSteps.size(); ++i) {
    const auto channel = links.at(moved(position, axis, kSteps.at(i) * kStep));
    if (!links.soft() && channel.pairs != pairs) {
      return std::nullopt;
    }
    for (std::size_t j = 0; j < reference.size(); ++j) {
      sum += kWeights.at(i) * std::norm(channel.h[j] - reference[j]);
    }
  }
  return sum / (12 * kStep);
}

class TargetGradients : public ::testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(TargetGradients, MatchCentralDifferences) {
  const auto& [scene, softness] = GetParam();
  const TargetLinks links(TracedLink::of(scene, {.max_depth = 3, .softness = softness}), {});
  double worst = 0.0;
  int compared = 0;
  for (const TargetPosition& position : kPlaces.at(scene)) {
    SCOPED_TRACE(std::to_string(position.x) + " " + std::to_string(position.y));
    const test::Csi reference =
        links.at({position.x + kReferenceShift.x, position.y + kReferenceShift.y}).h;
    test::Csi g = links.at(position).h;
    for (std::size_t j = 0; j < g.size(); ++j) {
      g[j] = 2.0 * (g[j] - reference[j]);
    }
    const std::array<double, 2> gradient = links.gradient(position, g);
    // By the larger of both where a derivative hardly matters.
    const double floor = 1e-3 * std::max(std::abs(gradient[0]), std::abs(gradient[1]));
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (const auto value = difference(links, position, axis, reference)) {
        const double error =
            std::abs(gradient.at(axis) - *value) / std::max(std::abs(*value), floor);
        EXPECT_LE(error, kTolerance) << gradient.at(axis) << " against " << *value;
        worst = std::max(worst, error);
        ++compared;
      }
    }
  }
  EXPECT_GE(compared, softness > 0.0 ? 10 : 8);
  if (std::getenv("RAYLOC_PRINT_GRADIENTS") != nullptr) {
    std::printf("| target position | %s, %s | %d | %.1e |\n",
                scene,
                softness > 0.0 ? "soft" : "hard",
                compared,
                worst);
  }
}

INSTANTIATE_TEST_SUITE_P(PastABody,
                         TargetGradients,
                         ::testing::Combine(::testing::Values("box", "meeting_room", "corridor"),
                                            ::testing::Values(0.0, 0.05)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) +
                                  (std::get<1>(test.param) > 0.0 ? "_soft" : "_hard");
                         });

}  // namespace
}  // namespace rayloc::target_gradients_test
