#include "engine/paper/calibration.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/paper/evaluator.h"
#include "engine/paper/loss.h"
#include "engine/paper/parameters.h"
#include "engine/paper/samples.h"

namespace rayloc::paper {
namespace {

using Values = Parameters::Values;
using SharedScene = std::shared_ptr<const Scene>;

// Name of the method's only stage, in a calibration's history.
constexpr const char* kStage = "objects and materials";
// A material that is lossless in the table may still become lossy, in steps of this size.
constexpr double kMinConductivity = 0.01;  // [S/m]

struct State {
  Values values;
  SharedScene scene;
};

Expected<void> check(const CalibrationOptions& options) {
  const auto refuse = [](const std::string& what) { return make_error(ErrorKind::kUsage, what); };
  if (options.iterations < 0 || options.max_depth < 0) {
    return refuse("the iterations and the depth of the paper's calibration are 0 or more");
  }
  if (!(options.softness >= 0.0) || !std::isfinite(options.softness)) {
    return refuse("the softness of edges is 0 m or more");
  }
  const auto is_positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (!is_positive(options.object_rate) || !is_positive(options.material_rate) ||
      !is_positive(options.floor) || !is_positive(options.descent.least)) {
    return refuse("rates and floors of the paper's calibration are more than 0");
  }
  const auto is_share = [](double x) { return x >= 0.0 && x < 1.0; };
  if (!is_share(options.descent.decay) || !is_share(options.descent.momentum)) {
    return refuse("decay and momentum of the descent are from 0 to below 1");
  }
  return validate(options.smoothing);
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

std::vector<double> material_rates(const Parameters& parameters, double share) {
  const auto start = parameters.initial().material;
  std::vector<double> rate;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const bool conductivity = parameters.materials()[i].kind == Parameter::Kind::kConductivity;
    rate.push_back(share * (conductivity ? std::max(start[i], kMinConductivity) : start[i]));
  }
  return rate;
}

// Number of points; a sample belongs to a point and an access point.
std::size_t points_of(std::span<const Sample> samples) {
  std::set<std::size_t> points;
  for (const Sample& sample : samples) {
    points.insert(sample.point);
  }
  return points.size();
}

// One run of the descent.
class CalibrationDescent {
 public:
  CalibrationDescent(const RoomModel& room,
                     const Samples& samples,
                     const CalibrationOptions& options)
      : room_(room),
        samples_(samples),
        options_(options),
        loss_(room.grid, options.smoothing, options.floor),
        evaluator_(room,
                   samples.training,
                   {.max_depth = options.max_depth, .softness = options.softness},
                   loss_),
        parameters_(room.scene, samples.met),
        position_steps_(std::vector<double>(parameters_.objects().size(), options.object_rate),
                        options.descent),
        material_steps_(material_rates(parameters_, options.material_rate), options.descent),
        state_{parameters_.initial(), room.scene},
        best_(state_),
        fitted_points_(points_of(samples.training)) {}

  Expected<void> run(const CalibrationObserver& observer, RoomCalibration& result);

  const SharedScene& best_scene() const { return best_.scene; }
  std::vector<RoomParameter> best_parameters() const { return parameters_.describe(best_.values); }

 private:
  bool report(double loss,
              int iteration,
              const CalibrationObserver& observer,
              RoomCalibration& result);
  Expected<void> rebuild();
  Expected<void> step(const std::vector<double>& position_gradient);

  const RoomModel& room_;
  const Samples& samples_;
  const CalibrationOptions& options_;
  Loss loss_;
  Evaluator evaluator_;
  Parameters parameters_;
  Rmsprop position_steps_;
  Rmsprop material_steps_;
  State state_;
  State best_;
  double best_loss_ = 0.0;
  std::size_t fitted_points_;
};

Expected<void> CalibrationDescent::rebuild() {
  parameters_.project(state_.values);
  auto scene = parameters_.scene_with(state_.values);
  RAYLOC_TRY(scene);
  state_.scene = *std::move(scene);
  return {};
}

Expected<void> CalibrationDescent::step(const std::vector<double>& position_gradient) {
  position_steps_.step(position_gradient, state_.values.translation);
  RAYLOC_TRY(rebuild());
  const auto moved =
      evaluator_.evaluate(state_.scene, LossKind::kRatioAmplitude, parameters_.materials());
  RAYLOC_TRY(moved);
  material_steps_.step(moved->gradient, state_.values.material);
  return rebuild();
}

bool CalibrationDescent::report(double loss,
                                int iteration,
                                const CalibrationObserver& observer,
                                RoomCalibration& result) {
  const double heldout =
      median(correlations(room_, state_.scene, samples_.held_out, options_.max_depth));
  result.history.push_back({kStage, iteration, loss, heldout});
  if (!observer) {
    return true;
  }
  const double share =
      options_.iterations > 0 ? static_cast<double>(iteration) / options_.iterations : 1.0;
  return observer({result.history.back(), share, fitted_points_});
}

Expected<void> CalibrationDescent::run(const CalibrationObserver& observer,
                                       RoomCalibration& result) {
  for (int iteration = 0;; ++iteration) {
    const auto here = evaluator_.evaluate(state_.scene, LossKind::kDelay, parameters_.objects());
    RAYLOC_TRY(here);
    if (iteration == 0 || here->sum() < best_loss_) {
      best_loss_ = here->sum();
      best_ = state_;
    }
    const bool go_on = report(here->sum(), iteration, observer, result);
    if (iteration == options_.iterations) {
      return {};
    }
    if (!go_on) {
      result.interrupted = true;
      return {};
    }
    RAYLOC_TRY(step(here->gradient));
  }
}

// Fits of training and held-out samples, in the order of the points.
std::vector<PointFit> point_fits(const RoomModel& room,
                                 const Samples& samples,
                                 const SharedScene& after,
                                 int max_depth) {
  std::vector<PointFit> fits;
  for (const auto* part : {&samples.training, &samples.held_out}) {
    const auto old_fit = correlations(room, room.scene, *part, max_depth);
    const auto new_fit = correlations(room, after, *part, max_depth);
    for (std::size_t i = 0; i < part->size(); ++i) {
      fits.push_back({(*part)[i].point, (*part)[i].access_point, old_fit[i], new_fit[i]});
    }
  }
  std::sort(fits.begin(), fits.end(), [](const PointFit& a, const PointFit& b) {
    return a.point != b.point ? a.point < b.point : a.access_point < b.access_point;
  });
  return fits;
}

}  // namespace

Expected<RoomCalibration> calibrate(const RoomModel& room,
                                    std::span<const CalibrationPoint> points,
                                    const CalibrationOptions& options,
                                    const CalibrationObserver& observer) {
  RAYLOC_TRY(check(options));
  const TraceOptions tracing{.max_depth = options.max_depth, .softness = options.softness};
  const auto samples = gather_samples(room, points, tracing);
  RAYLOC_TRY(samples);
  RoomCalibration result;
  result.room = room;
  CalibrationDescent descent(room, *samples, options);
  RAYLOC_TRY(descent.run(observer, result));
  result.room.scene = descent.best_scene();
  result.parameters = descent.best_parameters();
  result.points = point_fits(room, *samples, descent.best_scene(), options.max_depth);
  return result;
}

}  // namespace rayloc::paper
