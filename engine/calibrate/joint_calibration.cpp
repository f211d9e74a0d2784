#include "engine/calibrate/joint_calibration.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "engine/base/constants.h"
#include "engine/base/median.h"
#include "engine/base/parallel.h"
#include "engine/calibrate/chain_ripple.h"
#include "engine/calibrate/stated_parameter.h"
#include "engine/calibrate/stated_widths.h"
#include "engine/calibrate/surface_scan.h"
#include "engine/calibrate/wave_cycles.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

using Kind = Unknown::Kind;

constexpr double kDecidingShare = 0.15;  // of the points that are not held out
constexpr double kTolerance = 0.01;      // by which a round may lessen the correlation
constexpr std::size_t kLeastPoints = 4;
// Of the surfaces whose other half-wave cycles are tried.
constexpr double kTriedShare = 0.05;  // of the strongest's power, at least
constexpr std::size_t kMostTried = 8;
constexpr int kTrialIterations = 5;

enum class Use : std::uint8_t { kFit, kDecide, kHeldOut };

class JointCalibration {
 public:
  JointCalibration(const RoomModel& room,
                   std::span<const CalibrationPoint> points,
                   const JointCalibrationOptions& options,
                   const CalibrationObserver& observer)
      : original_(room),
        points_(points),
        options_(options),
        observer_(observer),
        unknowns_(room, options.priors),
        plain_(room.grid),
        model_(plain_) {
    draw_uses();
    for (std::size_t p = 0; p < points.size(); ++p) {
      for (std::size_t a = 0; a < points[p].h.size(); ++a) {
        if (!points[p].h[a].empty()) {
          sites_.push_back({p, a, points[p].position});
        }
      }
    }
    state_.values.resize(unknowns_.size());
    state_.survey.resize(points.size());
  }

  Expected<void> check() const;
  Expected<RoomCalibration> run();

 private:
  void draw_uses();
  Expected<void> retrace();
  void measure();
  void weigh(const JointRound& round);
  std::vector<char> released(const JointRound& round) const;
  JointOptions joint_options(const JointRound& round, std::span<const char> released) const;
  std::vector<JointSample> fitted() const;
  JointContext context(std::span<const JointSample> samples) const {
    return {model_, unknowns_, samples, traced_at_};
  }
  double half_wave() const { return 0.5 * kSpeedOfLight / original_.grid.centre_hz; }  // [m]
  std::vector<double> change() const { return context({}).change(state_.values); }
  std::vector<ChainGains> gains() const;
  void set_gains(std::span<const ChainGains> gains);
  double correlation(std::size_t sample, const ModelPoint& at) const;
  double median_correlation(Use use, std::span<const Vec3d> survey) const;
  double decided(const JointRound& round) const;
  bool solve(const JointRound& round, bool with_deciding, const char* stage);
  bool settle(const JointRound& round);
  Expected<bool> run_round(std::size_t index);
  void checkpoint(JointCheckpoint& reached) const;
  void finish(const JointRound& round);
  bool tell(const char* stage, double loss);
  bool go_on();
  void fold_chains();
  std::vector<Vec3d> placed(const JointRound& round, std::span<const JointSample> samples) const;
  std::vector<JointSample> used(Use use) const;
  std::vector<RoomParameter> parameters(const JointRound& round);

  RoomModel original_;  // its chain gains are improved
  std::span<const CalibrationPoint> points_;
  const JointCalibrationOptions& options_;
  const CalibrationObserver& observer_;
  RoomUnknowns unknowns_;
  SampleModel plain_;
  SampleModel model_;     // weighs coordinates
  std::vector<Use> use_;  // of each point
  std::vector<SampleSite> sites_;
  JointState state_;
  RoomModel room_;  // as traced
  std::vector<double> traced_at_;
  std::vector<TracedSample> traced_;
  std::vector<MeasuredSample> measured_;
  std::vector<std::vector<std::complex<double>>> h_;  // of each sample, chain gains removed
  std::vector<WaveCycle> other_cycles_;
  std::vector<CalibrationStep> history_;
  double heldout_ = 0.0;
  double share_ = 0.0;
  bool stopped_ = false;
};

void JointCalibration::draw_uses() {
  std::mt19937_64 random(options_.seed);
  use_.reserve(points_.size());
  for (const CalibrationPoint& point : points_) {
    const double drawn = static_cast<double>(random() >> 11) * 0x1p-53;
    use_.push_back(point.held_out           ? Use::kHeldOut
                   : drawn < kDecidingShare ? Use::kDecide
                                            : Use::kFit);
  }
}

Expected<void> JointCalibration::check() const {
  for (std::size_t a = 0; a < original_.access_points.size(); ++a) {
    std::size_t heard = 0;
    std::size_t usable = 0;
    for (const SampleSite& site : sites_) {
      if (site.access_point == a) {
        ++heard;
        usable += use_[site.point] == Use::kFit ? 1U : 0U;
      }
    }
    if (heard > 0 && usable < kLeastPoints) {
      return bad_input("access point " + original_.access_points[a].id + ": " +
                       std::to_string(usable) + " calibration points can be fitted, at least " +
                       std::to_string(kLeastPoints) + " are needed");
    }
  }
  if (sites_.empty()) {
    return bad_input("no access point heard the device at any of the points");
  }
  return {};
}

Expected<void> JointCalibration::retrace() {
  auto room = changed_room(original_, unknowns_, state_.values);
  if (!room) {
    return tl::make_unexpected(std::move(room.error()));
  }
  auto traced = trace_samples(*room, unknowns_, sites_, options_.trace);
  if (!traced) {
    return tl::make_unexpected(std::move(traced.error()));
  }
  room_ = *std::move(room);
  traced_ = *std::move(traced);
  traced_at_ = state_.values;
  for (std::uint32_t i = 0; i < unknowns_.size(); ++i) {
    const Kind kind = unknowns_[i].kind;
    if (kind == Kind::kSurfaceGain || kind == Kind::kSurfacePhase || kind == Kind::kChainGain ||
        kind == Kind::kChainPhase || kind == Kind::kCoupling) {
      traced_at_[i] = 0.0;  // no scene holds these
    }
  }
  measure();
  return {};
}

// Removes the chain gains and aligns to what is expected now.
void JointCalibration::measure() {
  h_.assign(sites_.size(), {});
  measured_.assign(sites_.size(), {});
  const std::vector<double> changed = change();
  parallel_for(sites_.size(), 1, [&](std::size_t i) {
    const SampleSite& site = sites_[i];
    const ChainGains& gains = original_.access_points[site.access_point].gains;
    h_[i] = points_[site.point].h[site.access_point];
    if (!gains.empty()) {
      remove_gains(gains, h_[i]);
    }
    measured_[i] = model_.measured(traced_[i], {changed, state_.survey[site.point]}, h_[i]);
  });
}

// Weighs the coordinates by what the fit so far leaves of them, once it is near.
void JointCalibration::weigh(const JointRound& round) {
  if (!round.survey) {
    return;
  }
  const std::vector<double> changed = change();
  Eigen::MatrixXcd left_over = plain_.nothing_left_over();
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    const std::size_t point = sites_[i].point;
    if (use_[point] == Use::kFit) {
      plain_.add_left_over(traced_[i], {changed, state_.survey[point]}, h_[i], left_over);
    }
  }
  model_ = plain_.weighed(left_over);
  measure();
}

std::vector<ChainGains> JointCalibration::gains() const {
  std::vector<ChainGains> result;
  for (const RoomAccessPoint& ap : original_.access_points) {
    result.push_back(ap.gains);
  }
  return result;
}

void JointCalibration::set_gains(std::span<const ChainGains> gains) {
  for (std::size_t a = 0; a < original_.access_points.size(); ++a) {
    original_.access_points[a].gains = gains[a];
  }
}

double JointCalibration::correlation(std::size_t sample, const ModelPoint& at) const {
  const auto expected = model_.expected_tones(traced_[sample], at);
  return model_.aligner().align(h_[sample], expected).correlation;
}

// `survey`: error of each point; empty: none.
double JointCalibration::median_correlation(Use use, std::span<const Vec3d> survey) const {
  const std::vector<double> changed = change();
  std::vector<double> each(sites_.size(), -1.0);
  parallel_for(sites_.size(), 1, [&](std::size_t i) {
    const std::size_t point = sites_[i].point;
    if (use_[point] == use) {
      each[i] = correlation(i, {changed, survey.empty() ? Vec3d{} : survey[point]});
    }
  });
  std::erase(each, -1.0);
  return each.empty() ? 0.0 : median(std::move(each));
}

// How well the points are met that decide. Where survey errors are fitted these points have theirs,
// too: at places that are millimetres off, a room nearer to the truth need not be met better.
double JointCalibration::decided(const JointRound& round) const {
  return median_correlation(
      Use::kDecide, round.survey ? placed(round, used(Use::kDecide)) : std::vector<Vec3d>());
}

std::vector<char> JointCalibration::released(const JointRound& round) const {
  return rayloc::released(round, unknowns_, surface_power(traced_, *room_.scene));
}

std::vector<JointSample> JointCalibration::used(Use use) const {
  std::vector<JointSample> samples;
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    if (use_[sites_[i].point] == use) {
      samples.push_back({&traced_[i], &measured_[i]});
    }
  }
  return samples;
}

// All but those held out.
std::vector<JointSample> JointCalibration::fitted() const {
  std::vector<JointSample> samples = used(Use::kFit);
  const std::vector<JointSample> deciding = used(Use::kDecide);
  samples.insert(samples.end(), deciding.begin(), deciding.end());
  return samples;
}

bool JointCalibration::tell(const char* stage, double loss) {
  history_.push_back({stage, static_cast<int>(history_.size()), loss, heldout_});
  return go_on();
}

// Between trials, which are no steps on the way.
bool JointCalibration::go_on() {
  if (observer_ && !observer_({history_.back(), share_, points_.size()})) {
    stopped_ = true;
  }
  return !stopped_;
}

bool JointCalibration::solve(const JointRound& round, bool with_deciding, const char* stage) {
  const std::vector<char> free = released(round);
  const auto samples = with_deciding ? fitted() : used(Use::kFit);
  const JointProblem problem(context(samples));
  problem.solve(joint_options(round, free), state_, [&](double unexplained) {
    share_ += 1.0 / static_cast<double>(kJointRounds * (options_.iterations + 3));
    return tell(stage, unexplained);
  });
  return !stopped_;
}

// Tries the other half-wave cycles of the strongest surfaces; where one is better, all is fitted
// again.
bool JointCalibration::settle(const JointRound& round) {
  const std::vector<char> free = released(round);
  const auto samples = used(Use::kFit);
  const auto strongest =
      strongest_surfaces(surface_power(traced_, *room_.scene), kTriedShare, kMostTried);
  WaveCycleSearch search{
      strongest, half_wave(), joint_options(round, free), [&] { return go_on(); }};
  search.options.iterations = kTrialIterations;
  const WaveCycles cycles = settle_wave_cycles(context(samples), search, state_);
  other_cycles_ = cycles.others;
  return !stopped_ && (!cycles.moved || solve(round, false, "fit"));
}

JointOptions JointCalibration::joint_options(const JointRound& round,
                                             std::span<const char> free) const {
  return {round.floor, options_.iterations, round.survey ? options_.priors.survey : 0.0, free};
}

// The gains of the chains found so far, and their ripple over the tones, go into the chain gains.
void JointCalibration::fold_chains() {
  const std::vector<double> changed = change();
  for (std::size_t a = 0; a < original_.access_points.size(); ++a) {
    std::vector<ArrayPair> pairs;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      if (sites_[i].access_point == a && use_[sites_[i].point] == Use::kFit) {
        pairs.push_back(
            {h_[i], model_.expected_tones(traced_[i], {changed, state_.survey[sites_[i].point]})});
      }
    }
    ChainGains& gains = original_.access_points[a].gains;
    if (pairs.empty() || gains.empty()) {
      continue;
    }
    const std::size_t tones = original_.grid.size();
    for (std::size_t e = 1; e * tones < gains.gain.size(); ++e) {
      double* chain = &state_.values[unknowns_.chain_gain(a, e)];
      const auto factor = std::polar(std::exp(chain[0]), chain[1]);
      for (std::size_t k = 0; k < tones; ++k) {
        gains.gain[e * tones + k] *= factor;
      }
      chain[0] = chain[1] = 0.0;
    }
    const ChainRipple ripple = chain_ripple(model_.aligner(), original_.grid, std::move(pairs));
    for (std::size_t k = 0; k < gains.gain.size(); ++k) {
      gains.gain[k] *= ripple.gain[k];
    }
  }
}

Expected<bool> JointCalibration::run_round(std::size_t index) {
  const JointRound& round = joint_round(index);
  share_ = static_cast<double>(index) / static_cast<double>(kJointRounds);
  const JointState before = state_;
  const std::vector<ChainGains> gains_before = gains();
  const std::vector<WaveCycle> cycles_before = other_cycles_;
  const double decided_before = decided(round);
  weigh(round);
  const auto samples = used(Use::kFit);
  scan_surfaces(context(samples),
                surface_power(traced_, *room_.scene),
                {round.floor, round.scan_range},
                state_);
  if (!tell("scan", mean_unexplained(context(samples), state_)) || !solve(round, false, "fit") ||
      (round.cycles && !settle(round))) {
    state_ = before;  // the last good one
    return false;
  }
  fold_chains();
  if (auto traced = retrace(); !traced) {
    return tl::make_unexpected(std::move(traced.error()));
  }
  if (decided(round) < decided_before - kTolerance) {
    state_ = before;
    other_cycles_ = cycles_before;
    set_gains(gains_before);
    if (auto traced = retrace(); !traced) {
      return tl::make_unexpected(std::move(traced.error()));
    }
    return false;
  }
  heldout_ = median_correlation(Use::kHeldOut, {});
  return true;
}

// Where the points really were, as errors of their survey, the room held.
std::vector<Vec3d> JointCalibration::placed(const JointRound& round,
                                            std::span<const JointSample> samples) const {
  const std::vector<char> none(unknowns_.size());
  const JointOptions options{round.floor, options_.iterations, options_.priors.survey, none};
  JointState state = state_;
  JointProblem(context(samples)).solve(options, state, {});
  return std::move(state.survey);
}

std::vector<RoomParameter> JointCalibration::parameters(const JointRound& round) {
  const std::vector<char> free = released(round);
  const auto samples = fitted();
  const JointContext about = context(samples);
  const std::vector<double> sigma = stated_widths(
      about,
      joint_options(round, free),
      state_,
      other_cycles_,
      {surface_power(traced_, *room_.scene), mean_unexplained(about, state_), half_wave()});
  std::vector<RoomParameter> result;
  for (std::uint32_t i = 0; i < unknowns_.size(); ++i) {
    const bool chain =
        unknowns_[i].kind == Kind::kChainGain || unknowns_[i].kind == Kind::kChainPhase;
    if (free[i] == 0 || chain) {  // chains are in the gains (fold_chains)
      continue;
    }
    result.push_back(stated_parameter(unknowns_[i], original_, state_.values[i], sigma[i]));
  }
  return result;
}

void JointCalibration::checkpoint(JointCheckpoint& reached) const {
  reached.state = state_;
  reached.gains = gains();
  reached.other_cycles = other_cycles_;
  if (options_.on_checkpoint) {
    options_.on_checkpoint(reached);
  }
}

// With the points that decided, too. Nobody is left to say whether another cycle is better, so
// none is tried.
void JointCalibration::finish(const JointRound& round) {
  if (stopped_) {
    return;
  }
  const JointState before = state_;
  weigh(round);
  if (solve(round, true, "all points")) {
    fold_chains();
  } else {
    state_ = before;
  }
}

Expected<RoomCalibration> JointCalibration::run() {
  if (auto traced = retrace(); !traced) {
    return tl::make_unexpected(std::move(traced.error()));
  }
  RoomCalibration result;
  const std::vector<double> at_first = change();
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    result.points.push_back(
        {sites_[i].point, sites_[i].access_point, correlation(i, {at_first, {}}), 0.0, 0.0});
  }
  heldout_ = median_correlation(Use::kHeldOut, {});
  JointCheckpoint reached;
  if (options_.resume != nullptr) {
    reached = *options_.resume;
    state_ = reached.state;
    set_gains(reached.gains);
    other_cycles_ = reached.other_cycles;
    if (auto traced = retrace(); !traced) {
      return tl::make_unexpected(std::move(traced.error()));
    }
  }
  while (reached.rounds < kJointRounds && !stopped_) {
    const auto kept = run_round(static_cast<std::size_t>(reached.rounds));
    if (!kept) {
      return tl::make_unexpected(kept.error());
    }
    if (!stopped_) {
      reached.last_kept = *kept ? reached.rounds : reached.last_kept;
      ++reached.rounds;
      checkpoint(reached);
    }
  }
  const JointRound& last = joint_round(static_cast<std::size_t>(reached.last_kept));
  finish(last);
  if (auto traced = retrace(); !traced) {
    return tl::make_unexpected(std::move(traced.error()));
  }
  const std::vector<double> at_last = change();
  parallel_for(sites_.size(), 1, [&](std::size_t i) {
    result.points[i].after = correlation(i, {at_last, {}});
  });
  std::vector<JointSample> all;
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    all.push_back({&traced_[i], &measured_[i]});
  }
  state_.survey = placed(last, all);
  parallel_for(sites_.size(), 1, [&](std::size_t i) {
    result.points[i].placed = correlation(i, {at_last, state_.survey[sites_[i].point]});
  });
  result.parameters = parameters(last);
  result.room = room_;
  result.room.trace = options_.use;
  result.history = std::move(history_);
  result.interrupted = stopped_;
  return result;
}

}  // namespace

Expected<RoomCalibration> calibrate_jointly(const RoomModel& room,
                                            std::span<const CalibrationPoint> points,
                                            const JointCalibrationOptions& options,
                                            const CalibrationObserver& observer) {
  JointCalibration calibration(room, points, options, observer);
  if (auto checked = calibration.check(); !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  return calibration.run();
}

}  // namespace rayloc
