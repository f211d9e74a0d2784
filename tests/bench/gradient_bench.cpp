// A loss of the channel with its gradient by the device's position, beside the loss alone.
//
// Laboratory, 3 antennas x 128 tones, depth 3, image trees there. The last lines are of least
// times. Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <vector>

#include "engine/trace/array_tracer.h"
#include "tests/bench/best_times.h"
#include "tests/bench/memory.h"
#include "tests/support/laboratory.h"

namespace rayloc::bench {
namespace {

constexpr int kTones = 128;
constexpr int kSteps = 100;
constexpr int kSamples = 5;
const std::array<Parameter, 2> kPlan{Parameter::transmitter_position(0),
                                     Parameter::transmitter_position(1)};

// L = sum |h - m|^2 for a channel m measured at another position.
class Loss {
 public:
  Loss()
      : tracer_(test::laboratory()),
        array_(tracer_, test::laboratory_access_point()),
        place_(test::laboratory_positions(2)) {
    grid_ = {tracer_.scene().carrier_hz(), 312'500.0, {}};
    for (int i = 0; i < kTones; ++i) {
      grid_.tone_index.push_back(static_cast<std::int16_t>(i - kTones / 2));
    }
    measured_ = array_csi(array_.trace(Transmitter{{place_[1], {}}}), grid_);
  }

  // The memory of a path with its derivatives.
  double bytes_per_path() const {
    std::size_t count = 0;
    std::size_t bytes = 0;
    for (const Paths& paths : array_.trace(Transmitter{{place_[0], {}}})) {
      count += paths.size();
      bytes += bytes_of(paths) + paths.size() * kPlan.size() * sizeof(PathDerivatives::Derivative);
    }
    return static_cast<double>(bytes) / static_cast<double>(count);
  }

  const Vec3d& start() const { return place_[0]; }

  double value(const Vec3d& position) const {
    const auto h = array_csi(array_.trace(Transmitter{{position, {}}}), grid_);
    double sum = 0.0;
    for (std::size_t j = 0; j < h.size(); ++j) {
      sum += std::norm(h[j] - measured_[j]);
    }
    return sum;
  }

  std::array<double, 3> value_and_gradient(const Vec3d& position) const {
    const Transmitter device{{position, {}}};
    const std::vector<Paths> paths = array_.trace(device);
    auto g = array_csi(paths, grid_);
    double sum = 0.0;
    for (std::size_t j = 0; j < g.size(); ++j) {
      const std::complex<double> difference = g[j] - measured_[j];
      sum += std::norm(difference);
      g[j] = 2.0 * difference;
    }
    const auto derivatives = array_.differentiate(device, paths, kPlan);
    const auto gradient = array_loss_gradient(*derivatives, paths, grid_, g);
    return {sum, gradient[0], gradient[1]};
  }

 private:
  PathTracer tracer_;
  ArrayTracer array_;
  std::vector<Vec3d> place_;
  OfdmGrid grid_;
  std::vector<std::complex<double>> measured_;
};

const Loss& loss() {
  static const Loss kLoss;
  return kLoss;
}

void BM_Loss(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(loss().value(loss().start()));
  }
}
BENCHMARK(BM_Loss)->Unit(benchmark::kMicrosecond)->Repetitions(5);

void BM_LossAndGradient(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(loss().value_and_gradient(loss().start()));
  }
}
BENCHMARK(BM_LossAndGradient)->Unit(benchmark::kMicrosecond)->Repetitions(5);

// As a localizer would: steps along the normalised mean gradient of samples around the position.
void BM_Descent(benchmark::State& state) {
  for (auto _ : state) {
    Vec3d at = loss().start();
    for (int step = 0; step < kSteps; ++step) {
      double gx = 0.0;
      double gy = 0.0;
      for (int sample = 0; sample < kSamples; ++sample) {
        const double angle = 1.2566 * sample + 0.7 * step;
        const Vec3d near{at.x + 0.02 * std::cos(angle), at.y + 0.02 * std::sin(angle), at.z};
        const auto found = loss().value_and_gradient(near);
        gx += found[1];
        gy += found[2];
      }
      const double size = std::hypot(gx, gy);
      at.x -= 0.003 * gx / size;
      at.y -= 0.003 * gy / size;
    }
    benchmark::DoNotOptimize(at);
  }
}
BENCHMARK(BM_Descent)->Unit(benchmark::kMillisecond)->Iterations(1)->Repetitions(5);

void print_summary(const BestTimes& best) {
  const auto alone = best.find("BM_Loss");
  const auto both = best.find("BM_LossAndGradient");
  const auto descent = best.find("BM_Descent");
  if (alone && both) {
    std::printf("loss %.0f us, with gradient %.0f us of wall clock: %.2f times\n",
                1e6 * alone->wall,
                1e6 * both->wall,
                both->wall / alone->wall);
  }
  if (descent) {
    std::printf("descent of %d steps x %d samples: %.3f s\n", kSteps, kSamples, descent->wall);
  }
  std::printf("a path with two derivatives: %.0f bytes\n", loss().bytes_per_path());
  print_peak_memory();
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  return rayloc::bench::run_benchmarks(argc, argv, rayloc::bench::print_summary);
}
