#include "engine/calibrate/joint/joint_calibration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/constants.h"
#include "engine/base/median.h"
#include "engine/base/parallel.h"
#include "engine/calibrate/chain_ripple.h"
#include "engine/calibrate/joint/joint_run.h"
#include "engine/calibrate/joint/reported_sigma.h"
#include "engine/calibrate/joint/stated_parameter.h"
#include "engine/calibrate/joint/surface_scan.h"
#include "engine/calibrate/joint/wave_cycles.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

using Kind = Unknown::Kind;

constexpr double kTolerance = 0.01;  // largest decrease of the correlation in a round
constexpr double kMinStep = 0.2;     // share of the least-squares step
constexpr int kShortenedPasses = 3;  // passes of a round with shortened steps
// Selection of the surfaces whose other half-wave cycles are tried.
constexpr double kTriedShare = 0.05;  // of the strongest's power, at least
constexpr std::size_t kMaxTried = 8;  // a count, chosen: bounds the time of the trials
constexpr int kTrialIterations = 5;   // a count, chosen: a better state is then fitted fully
// Progress steps of a part besides the iterations: the scan, and Ceres's call before the first.
constexpr int kStepsBesides = 2;
// [m], chosen: initial value for a survey of unknown accuracy. If the assumed value is too small,
// points that are far off explain nothing, and their errors cannot be estimated.
constexpr double kSurveyToBegin = 0.03;
// A ratio, chosen: if the survey error found differs this much from the assumed one, refit.
constexpr double kOtherSurvey = 1.2;
constexpr int kSurveyFits = 3;  // a count, chosen: at most, in a round

}  // namespace

JointCalibration::JointCalibration(const RoomModel& room,
                                   std::span<const CalibrationPoint> points,
                                   const JointCalibrationOptions& options,
                                   const CalibrationObserver& observer)
    : original_(room),
      points_(points),
      options_(options),
      unknowns_(room, options.priors),
      plain_(room.grid),
      model_(plain_),
      use_(draw_uses(points, options.seed)),
      survey_sigma_(options.finds_survey ? kSurveyToBegin : options.priors.survey),
      progress_(observer, fitted_points(points, use_), options.iterations + kStepsBesides) {
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (std::size_t a = 0; a < points[p].h.size(); ++a) {
      if (!points[p].h[a].empty()) {
        sites_.push_back({p, a, points[p].position});
      }
    }
  }
  assumed_ = gains();
  state_.values.resize(unknowns_.size());
  state_.survey.resize(points.size());
}

Expected<void> JointCalibration::retrace() {
  auto room = changed_room(original_, unknowns_, state_.values);
  RAYLOC_TRY(room);
  auto traced = trace_samples(*room, unknowns_, sites_, options_.trace);
  RAYLOC_TRY(traced);
  traced_ = *std::move(traced);
  power_ = surface_power(traced_, *room->scene);
  traced_at_ = state_.values;
  for (std::uint32_t i = 0; i < unknowns_.size(); ++i) {
    const Kind kind = unknowns_[i].kind;
    if (kind == Kind::kSurfaceGain || kind == Kind::kSurfacePhase || kind == Kind::kChainGain ||
        kind == Kind::kChainPhase || kind == Kind::kCoupling) {
      traced_at_[i] = 0.0;  // not represented by a scene
    }
  }
  measure();
  return {};
}

// Removes the chain gains and aligns to the currently expected arrays.
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

// Weights the coordinates by the residual of the fit so far, once it is close.
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
double JointCalibration::median_correlation(std::span<const Use> uses,
                                            std::span<const Vec3d> survey) const {
  const std::vector<double> changed = change();
  std::vector<double> each(sites_.size(), -1.0);
  parallel_for(sites_.size(), 1, [&](std::size_t i) {
    const std::size_t point = sites_[i].point;
    if (std::find(uses.begin(), uses.end(), use_[point]) != uses.end()) {
      each[i] = correlation(i, {changed, survey.empty() ? Vec3d{} : survey[point]});
    }
  });
  std::erase(each, -1.0);
  return each.empty() ? 0.0 : median(std::move(each));
}

// Median correlation of the points. Where survey errors are fitted, they are fitted for these
// points, too: at places that are millimetres off, a room nearer to the truth need not fit better.
double JointCalibration::met(const JointRound& round, std::span<const Use> uses) const {
  return median_correlation(uses, round.survey ? placed(round, used(uses)) : std::vector<Vec3d>());
}

std::vector<char> JointCalibration::released(const JointRound& round) const {
  return rayloc::released(round, unknowns_, power_);
}

std::vector<JointSample> JointCalibration::used(std::span<const Use> uses) const {
  std::vector<JointSample> samples;
  for (const Use use : uses) {
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      if (use_[sites_[i].point] == use) {
        samples.push_back({&traced_[i], &measured_[i]});
      }
    }
  }
  return samples;
}

bool JointCalibration::solve(const JointRound& round,
                             std::span<const Use> uses,
                             const char* stage) {
  const std::vector<char> free = released(round);
  const auto samples = used(uses);
  JointProblem(context(samples)).solve(joint_options(round, free), state_, [&](double unexplained) {
    progress_.advance();
    return progress_.report(stage, unexplained);
  });
  return !progress_.is_stopped();
}

// Tries the other half-wave cycles of the strongest surfaces; if one is better, all unknowns are
// fitted again.
bool JointCalibration::settle(const JointRound& round) {
  const std::vector<char> free = released(round);
  const auto samples = used(kFitted);
  const auto strongest = strongest_surfaces(power_, kTriedShare, kMaxTried);
  WaveCycleSearch search{
      strongest, half_wave(), joint_options(round, free), [&] { return progress_.go_on(); }};
  search.options.iterations = kTrialIterations;
  const WaveCycles cycles = settle_wave_cycles(context(samples), search, state_);
  other_cycles_ = cycles.others;
  return !progress_.is_stopped() && (!cycles.moved || solve(round, kFitted, "fit"));
}

JointOptions JointCalibration::joint_options(const JointRound& round,
                                             std::span<const char> free) const {
  return {round.floor, options_.iterations, round.survey ? survey_sigma_ : 0.0, free};
}

// Moves the chain factors found so far, and their ripple over the tones, into the chain gains.
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
  measure();  // no path depends on them
}

// Scans the surfaces, the strongest first, then fits all released unknowns at once.
bool JointCalibration::search(const JointRound& round, bool cycles) {
  weigh(round);
  const auto samples = used(kFitted);
  scan_surfaces(context(samples), power_, {round.floor, round.scan_range}, state_);
  progress_.advance();
  return progress_.report("scan", mean_unexplained(context(samples), state_)) &&
         solve(round, kFitted, "fit") && find_survey(round) && (!cycles || settle(round));
}

// Estimates the accuracy of the survey from the fitted errors, where it is not given, and fits
// these again.
bool JointCalibration::find_survey(const JointRound& round) {
  if (!options_.finds_survey || !round.survey) {
    return true;
  }
  const std::vector<char> free = released(round);
  const auto samples = used(kFitted);
  for (int i = 0; i < kSurveyFits; ++i) {
    const double before = survey_sigma_;
    survey_sigma_ = JointProblem(context(samples)).survey_sigma(joint_options(round, free), state_);
    const double ratio = survey_sigma_ / before;
    if (ratio < kOtherSurvey && 1.0 / ratio < kOtherSurvey) {
      return true;
    }
    if (!solve(round, kFitted, "survey")) {
      return false;
    }
  }
  return true;
}

// Moves towards the solution as far as the room, traced anew, confirms it, and returns the share
// of the step; 0: back at `before`. The least squares use only derivatives of the room: a
// reflection near its null, or a surface that moves behind another one, is not where they
// predict.
Expected<double> JointCalibration::go_from(const JointState& before,
                                           double met_before,
                                           const JointRound& round,
                                           std::span<const Use> uses) {
  const JointState solved = state_;
  for (double share = 1.0; share > kMinStep; share *= 0.5) {
    state_ = between(before, solved, share);
    RAYLOC_TRY(retrace());
    if (met(round, uses) >= met_before - kTolerance) {
      fold_chains();
      return share;
    }
  }
  state_ = before;
  return retrace().map([] { return 0.0; });
}

// Returns true if the state moved. A shortened step is an intermediate one: at its end the
// derivatives are different.
Expected<bool> JointCalibration::run_round(std::size_t index) {
  const JointRound& round = joint_round(index);
  progress_.begin_part(static_cast<int>(index));
  const JointCheckpoint at_first{0, 0, state_, gains(), other_cycles_, {}, survey_sigma_};
  bool has_moved = false;
  double share = 0.0;
  for (int pass = 0; pass < kShortenedPasses && share < 1.0; ++pass) {
    const JointState before = state_;
    const double met_before = met(round, deciders(use_));
    if (!search(round, round.cycles && pass == 0)) {
      return go_back_to(at_first).map([] { return false; });  // the last good state
    }
    const auto gone = go_from(before, met_before, round, deciders(use_));
    RAYLOC_TRY(gone);
    share = *gone;
    has_moved = has_moved || share > 0.0;
    if (share == 0.0) {
      break;
    }
  }
  if (!has_moved) {
    other_cycles_ = at_first.other_cycles;
  }
  progress_.set_heldout(median_correlation(kHeldOut, {}));
  return has_moved;
}

Expected<void> JointCalibration::go_back_to(const JointCheckpoint& reached) {
  state_ = reached.state;
  set_gains(reached.gains);
  other_cycles_ = reached.other_cycles;
  survey_sigma_ = reached.survey_sigma > 0.0 ? reached.survey_sigma : survey_sigma_;
  return retrace();
}

// Survey errors of the points, fitted with the room held.
std::vector<Vec3d> JointCalibration::placed(const JointRound& round,
                                            std::span<const JointSample> samples) const {
  const std::vector<char> none(unknowns_.size());
  const JointOptions options{round.floor, options_.iterations, survey_sigma_, none};
  JointState state = state_;
  JointProblem(context(samples)).solve(options, state, {});
  return std::move(state.survey);
}

std::vector<RoomParameter> JointCalibration::parameters(const JointRound& round) {
  const std::vector<char> free = released(round);
  const auto samples = used(kAllButHeldOut);
  const JointContext about = context(samples);
  const std::vector<double> sigma =
      reported_sigma(about,
                     joint_options(round, free),
                     state_,
                     other_cycles_,
                     {power_, mean_unexplained(about, state_), half_wave()});
  std::vector<RoomParameter> result;
  for (std::uint32_t i = 0; i < unknowns_.size(); ++i) {
    const bool chain =
        unknowns_[i].kind == Kind::kChainGain || unknowns_[i].kind == Kind::kChainPhase;
    if (free[i] == 0) {
      continue;
    }
    if (!chain) {
      result.push_back(stated_parameter(unknowns_[i], original_, state_.values[i], sigma[i]));
    } else if (const std::uint32_t a = unknowns_[i].index; !assumed_[a].empty()) {
      const ChainGains& found = original_.access_points[a].gains;  // from fold_chains
      result.push_back(stated_chain(unknowns_[i], original_, assumed_[a], found, sigma[i]));
    }
  }
  return result;
}

void JointCalibration::checkpoint(JointCheckpoint& reached) const {
  reached.state = state_;
  reached.gains = gains();
  reached.other_cycles = other_cycles_;
  reached.history = progress_.history();
  reached.survey_sigma = survey_sigma_;
  if (options_.on_checkpoint) {
    options_.on_checkpoint(reached);
  }
}

// Includes the points that decided. No point is left to decide whether another cycle is better, so
// none is tried.
Expected<double> JointCalibration::finish(const JointRound& round) {
  if (progress_.is_stopped()) {
    return 0.0;
  }
  progress_.begin_part(kJointRounds);
  const JointState before = state_;
  const double met_before = met(round, kAllButHeldOut);
  weigh(round);
  if (!solve(round, kAllButHeldOut, "all points")) {
    state_ = before;
    return 0.0;
  }
  return go_from(before, met_before, round, kAllButHeldOut);
}

Expected<RoomCalibration> JointCalibration::run() {
  RAYLOC_TRY(retrace());
  RoomCalibration result;
  const std::vector<double> at_first = change();
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    result.points.push_back(
        {sites_[i].point, sites_[i].access_point, correlation(i, {at_first, {}}), 0.0, 0.0});
  }
  JointCheckpoint reached;
  if (options_.resume != nullptr) {
    reached = *options_.resume;
    progress_.continue_from(reached.history);
    RAYLOC_TRY(go_back_to(reached));
  }
  progress_.set_heldout(median_correlation(kHeldOut, {}));
  checkpoint(reached);  // lets a run that is interrupted in the first round resume, too
  while (reached.rounds < kJointRounds && !progress_.is_stopped()) {
    const auto kept = run_round(static_cast<std::size_t>(reached.rounds));
    RAYLOC_TRY(kept);
    if (!progress_.is_stopped()) {
      reached.last_kept = *kept ? reached.rounds : reached.last_kept;
      ++reached.rounds;
      checkpoint(reached);
    }
  }
  const JointRound& last = joint_round(static_cast<std::size_t>(reached.last_kept));
  RAYLOC_TRY(finish(last));
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
  auto calibrated = changed_room(original_, unknowns_, state_.values);
  RAYLOC_TRY(calibrated);
  result.room = *std::move(calibrated);
  result.room.trace = options_.use;
  result.history = progress_.history();
  result.survey_sigma = survey_sigma_;
  result.interrupted = progress_.is_stopped();
  return result;
}

Expected<RoomCalibration> calibrate_jointly(const RoomModel& room,
                                            std::span<const CalibrationPoint> points,
                                            const JointCalibrationOptions& options,
                                            const CalibrationObserver& observer) {
  JointCalibration calibration(room, points, options, observer);
  RAYLOC_TRY(calibration.check());
  return calibration.run();
}

}  // namespace rayloc
