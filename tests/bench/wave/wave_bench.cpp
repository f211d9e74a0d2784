// Tests if edges and diffuse scattering explain points that no fit has used, on recordings of a
// calibrated site:
//
//   wave_bench [--reflected] [--made] SITE POINTS.csv [AP=]FILE...
//
// POINTS: surveyed, and not among those that SITE was calibrated with. The errors of the model
// (ModelError) are fitted anew to every second point, for each kind of likelihood, and judged on
// the others; then the other way round. Prints a line for each access point and kind: the
// log-likelihood of a point, and the logarithm of the probability of the right one of all points,
// each with its gain over the product's likelihood and the standard error of the gain; then the
// fitted errors. --reflected: also the density with one reflection before or after (slow in a
// corridor). --made: the recordings are replaced by simulations of the room as calibrated, edges
// included: a check that edges are found where they exist.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numeric>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/calibration_inputs.h"
#include "daemon/lab/calibrate/calibration_points.h"
#include "daemon/site/model/room_model.h"
#include "engine/base/median.h"
#include "engine/base/parallel.h"
#include "engine/calibrate/model_error_fit.h"
#include "engine/observe/alignment.h"
#include "tests/bench/wave/wave_likelihood.h"

namespace rayloc::bench {
namespace {

constexpr double kSurveyError = 0.005;  // [m], what the datasets state
constexpr double kEvidence = 0.1;       // as a calibration weighs a burst (access_point_fit.cpp)
constexpr std::size_t kFolds = 2;       // a count: fitted to one half, judged on the other

std::vector<WaveVariant> variants_of(bool reflected) {
  std::vector<WaveVariant> all = {
      {.name = "rays and tail (today)"},
      {.name = "edges", .edge_amplitude = 1.0},
      {.name = "edges, half their amplitude", .edge_amplitude = 0.5},
      {.name = "edges, half, power only", .edge_amplitude = 0.5, .edge_phase = false},
      {.name = "one interaction more", .edge_amplitude = 1.0, .deeper = true},
      {.name = "one more, power only", .edge_amplitude = 1.0, .edge_phase = false, .deeper = true},
  };
  for (std::size_t i = 0; i < (reflected ? kDensities : 1); ++i) {
    const std::string name = i == 0 ? "density" : "density, one reflection";
    all.push_back({.name = name + ", a quarter, and tail", .traced_share = 0.25, .density = i});
    all.push_back(
        {.name = name + " with a tail", .traced_share = 1.0, .density = i, .lingers = true});
    all.push_back({.name = name + " with a tail, its power",
                   .traced_share = 1.0,
                   .density = i,
                   .lingers = true,
                   .absolute = true});
  }
  return all;
}

double seconds_of_cpu() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Options {
  bool reflected = false;
  bool made = false;
};

struct Received {
  std::vector<WaveSample> samples;
  std::vector<std::vector<std::complex<double>>> h;  // chain gains removed
};

class Judge {
 public:
  Judge(const RoomModel& room,
        const RoomAccessPoint& access_point,
        const WaveLikelihood& likelihood)
      : room_(room), access_point_(access_point), likelihood_(likelihood) {}

  // By the fold that has not seen a point.
  struct Judged {
    std::vector<double> likelihood;  // its log-likelihood where it is
    // Logarithm of the probability of where it is, were it at one of the points.
    std::vector<double> place;
    ModelError fitted;  // by the first fold
  };
  Judged judged(const Received& received, const WaveVariant& variant) const {
    const std::size_t count = received.samples.size();
    std::vector<PreparedPlace> prepared(count);
    parallel_for(count, 4, [&](std::size_t i) {
      prepared[i] = likelihood_.prepare(received.samples[i].place, variant);
    });
    const auto model = [&](std::size_t i, const ModelError& error) {
      return likelihood_.model_of(received.samples[i].place, prepared[i], variant, error);
    };
    Judged judged{std::vector<double>(count), std::vector<double>(count), {}};
    for (std::size_t fold = 0; fold < kFolds; ++fold) {
      const auto evidence = [&](const ModelError& error) {
        std::vector<double> each(count);
        parallel_for(count, 4, [&](std::size_t i) {
          if (i % kFolds == fold) {
            each[i] =
                ObservationModel::log_likelihood(model(i, error), received.samples[i].observed);
          }
        });
        return kEvidence * std::accumulate(each.begin(), each.end(), 0.0);
      };
      const ModelError error = fit_model_error(evidence, calibrated()).value();
      judged.fitted = fold == 0 ? error : judged.fitted;
      std::vector<PlaceModel> models(count);
      parallel_for(count, 4, [&](std::size_t i) { models[i] = model(i, error); });
      parallel_for(count, 1, [&](std::size_t i) {
        if (i % kFolds != fold) {
          judge(models, received.samples[i].observed, i, judged);
        }
      });
    }
    return judged;
  }

  // Median correlation of measured and expected arrays, with so much of the edges' amplitude.
  double correlation(const Received& received, const WaveTracer& tracer, double edges) const {
    const Aligner aligner(room_.grid);
    std::vector<double> values(received.samples.size());
    parallel_for(values.size(), 4, [&](std::size_t i) {
      const WavePlace& place = received.samples[i].place;
      std::vector<Ray> rays = place.rays;
      for (const EdgeRay& edge : place.edges) {
        rays.push_back(edge.ray);
      }
      const ModelError& error = access_point_.error;
      const auto terms =
          likelihood_.model().ray_terms({rays, likelihood_.offsets(), 0.0, kSurveyError}, error);
      std::vector<double> known;
      for (std::size_t p = place.rays.size(); p < rays.size(); ++p) {
        known.push_back(edges * terms.parts[p].known);
      }
      double first = place.rays.front().length;
      for (const Ray& ray : place.rays) {
        first = std::min(first, ray.length);
      }
      auto expected = likelihood_.model().expected(
          {place.rays, likelihood_.offsets(), 0.0, kSurveyError}, error);
      const auto over = tracer.edge_csi(place, known, first);
      for (std::size_t j = 0; j < over.size(); ++j) {
        expected[j] += over[j];
      }
      values[i] = aligner.align(expected, received.h[i]).correlation;
    });
    return median(values);
  }

 private:
  void judge(const std::vector<PlaceModel>& models,
             const ObservedArray& observed,
             std::size_t point,
             Judged& judged) const {
    std::vector<double> tempered;
    tempered.reserve(models.size());
    for (const PlaceModel& model : models) {
      tempered.push_back(room_.likelihood_exponent *
                         ObservationModel::log_likelihood(model, observed));
    }
    const double top = *std::max_element(tempered.begin(), tempered.end());
    double sum = 0.0;
    for (const double one : tempered) {
      sum += std::exp(one - top);
    }
    judged.likelihood[point] = tempered[point] / room_.likelihood_exponent;
    judged.place[point] = tempered[point] - top - std::log(sum);
  }

  FittedModelError calibrated() const {
    const ModelError& error = access_point_.error;
    FittedModelError fit = assumed_model_error();
    fit.plan_tolerance.value = error.plan_tolerance;
    fit.diffuse.value = error.diffuse;
    fit.diffuse_exponent.value = error.diffuse_exponent;
    fit.diffuse_decay.value = error.diffuse_decay;
    fit.noise.value = error.noise;
    return fit;
  }

  const RoomModel& room_;
  const RoomAccessPoint& access_point_;
  const WaveLikelihood& likelihood_;
};

void print_powers(const Received& received, std::size_t densities) {
  std::vector<double> edges;
  std::vector<double> count;
  for (const WaveSample& sample : received.samples) {
    double rays = 0.0;
    double over = 0.0;
    for (const Ray& ray : sample.place.rays) {
      rays += std::norm(ray.amplitude);
    }
    for (const EdgeRay& edge : sample.place.edges) {
      over += std::norm(edge.ray.amplitude);
    }
    edges.push_back(10.0 * std::log10(over / rays));
    count.push_back(static_cast<double>(sample.place.edges.size()));
  }
  std::printf("  edges: median %.0f rays, %.1f dB of the power of the others",
              median(count),
              median(edges));
  for (std::size_t i = 0; i < densities; ++i) {
    std::vector<double> power;
    for (const WaveSample& sample : received.samples) {
      power.push_back(10.0 * std::log10(sample.place.density.at(i).power));
    }
    std::printf("; density %zu: %.1f dB", i, median(power));
  }
  std::printf("\n");
}

// A density's power counts from its median over the points, so that d keeps its size.
void scale_powers(Received& received, std::size_t densities) {
  for (std::size_t i = 0; i < densities; ++i) {
    std::vector<double> power;
    for (const WaveSample& sample : received.samples) {
      power.push_back(sample.place.density.at(i).power);
    }
    const double middle = median(power);
    for (WaveSample& sample : received.samples) {
      sample.place.density.at(i).power /= middle;
    }
  }
}

// "more than today | its standard error"
std::string beside(const std::vector<double>& values, const std::vector<double>& today) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i] - today[i];
    squares += (values[i] - today[i]) * (values[i] - today[i]);
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(),
                text.size(),
                "%+.2f | %.2f",
                sum / n,
                std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n)) / n));
  return text.data();
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

void print_row(const std::string& id,
               const WaveVariant& variant,
               const Judge::Judged& values,
               const Judge::Judged& today) {
  const ModelError& error = values.fitted;
  std::printf("| %s | %s | %.2f | %s | %.2f | %s | %.1f mm | %.3f | %.2f | %.1f ns | %.1e |\n",
              id.c_str(),
              variant.name.c_str(),
              mean(values.likelihood),
              beside(values.likelihood, today.likelihood).c_str(),
              mean(values.place),
              beside(values.place, today.place).c_str(),
              1e3 * error.plan_tolerance,
              error.diffuse,
              error.diffuse_exponent,
              1e9 * error.diffuse_decay,
              error.noise);
  std::fflush(stdout);
}

void study(const RoomModel& room,
           std::size_t number,
           const std::vector<CalibrationPoint>& points,
           const Options& options) {
  const RoomAccessPoint& ap = room.access_points[number];
  const WaveLikelihood likelihood(room.grid, ap, kSurveyError);
  const std::size_t densities = options.reflected ? kDensities : 1;
  const WaveTracer tracer(room, ap, {.edges = true, .densities = densities});
  std::vector<const CalibrationPoint*> used;
  for (const CalibrationPoint& point : points) {
    if (!point.h[number].empty()) {
      used.push_back(&point);
    }
  }
  const double before = seconds_of_cpu();
  Received received{std::vector<WaveSample>(used.size()), {}};
  parallel_for(used.size(), 1, [&](std::size_t i) {
    received.samples[i].place = tracer.trace(used[i]->position);
  });
  std::printf("%s: %zu points, %.1f s of CPU to trace\n",
              ap.id.c_str(),
              used.size(),
              seconds_of_cpu() - before);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (received.samples[i].place.rays.empty()) {
      continue;
    }
    auto h = options.made ? tracer.edge_recording(used[i]->position) : used[i]->h[number];
    if (!options.made) {
      remove_gains(ap.gains, h);
    }
    received.samples[i].observed = likelihood.model().observe(h);
    received.h.push_back(std::move(h));
    std::swap(received.samples[kept++], received.samples[i]);
  }
  received.samples.resize(kept);
  print_powers(received, densities);
  scale_powers(received, densities);
  const Judge judge(room, ap, likelihood);
  const double plain = judge.correlation(received, tracer, 0.0);
  std::printf("  median correlation: %.4f, with edges %.4f, with half of their amplitude %.4f\n",
              plain,
              judge.correlation(received, tracer, 1.0),
              judge.correlation(received, tracer, 0.5));
  std::printf("  not explained by rays: %.1f dB of the power\n", 10.0 * std::log10(1.0 - plain));
  Judge::Judged today;
  for (const WaveVariant& variant : variants_of(options.reflected)) {
    const Judge::Judged values = judge.judged(received, variant);
    if (today.place.empty()) {
      today = values;
    }
    print_row(ap.id, variant, values, today);
  }
}

int run(const std::vector<std::string>& arguments, const Options& options) {
  if (arguments.size() < 3) {
    std::fputs("wave_bench [--reflected] [--made] SITE POINTS.csv [AP=]FILE...\n", stderr);
    return 64;
  }
  const auto site = load_site(arguments[0]);
  const auto room = site ? load_room_model(*site) : tl::make_unexpected(site.error());
  if (!room) {
    std::fprintf(stderr, "wave_bench: %s\n", room.error().message.c_str());
    return 65;
  }
  const auto captures = resolve_captures(
      {arguments.begin() + 2, arguments.end()}, access_point_ids(*site), PerAccessPoint::kSeveral);
  auto inputs = captures ? read_calibration_inputs(*site, *captures, arguments[1])
                         : tl::make_unexpected(captures.error());
  if (!inputs) {
    std::fprintf(stderr, "wave_bench: %s\n", inputs.error().message.c_str());
    return 65;
  }
  const std::vector<bool> held(inputs->points.size(), true);
  const auto survey = combine_survey(*room, held, arguments[1], *inputs);
  std::puts(
      "| access point | kind | likelihood | more | error | right place | more | error | tolerance "
      "| "
      "diffuse | growth | decay | rest |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (std::size_t a = 0; a < room->access_points.size(); ++a) {
    study(*room, a, survey.points, options);
  }
  return 0;
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  std::vector<std::string> arguments;
  rayloc::bench::Options options;
  for (const std::string& argument : std::vector<std::string>(argv + 1, argv + argc)) {
    options.reflected = options.reflected || argument == "--reflected";
    options.made = options.made || argument == "--made";
    if (argument.rfind("--", 0) != 0) {
      arguments.push_back(argument);
    }
  }
  return rayloc::bench::run(arguments, options);
}
