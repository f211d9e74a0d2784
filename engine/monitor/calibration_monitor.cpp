#include "engine/monitor/calibration_monitor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/monitor/chain_turns.h"
#include "engine/monitor/monitored_point.h"
#include "engine/observe/alignment.h"
#include "engine/observe/burst.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr std::size_t kFramesOfBurst = 6;  // a count, chosen: bounds the memory of a window
constexpr std::size_t kScannedRays = 16;   // the strongest; the scan needs only the main part
constexpr double kShiftStep = 0.01;        // [m], a sixth of a wavelength
// [rad], chosen: the scan has three steps to either side within 6 degrees.
constexpr double kYawStep = 2.0 * kDegree;
constexpr double kSlowness = 0.05;  // weight of a new window in the slow mean: twenty windows
// [rad], 75 degrees: a bound on phases that grows with their sigma must not hide a quarter turn.
constexpr double kMaxJumpBound = 1.309;
// [rad]: chips start at least a quarter turn apart. A phase less certain than that shows no jump.
constexpr double kQuarterTurn = 1.571;
// A motion is accepted when it leaves at most this share of the power unexplained by the chains.
constexpr double kBetter = 0.5;

std::string rounded(double value) { return std::to_string(std::lround(value)); }

std::string percent(double share) { return rounded(100.0 * share) + " %"; }

bool is_worse(double unexplained, double usual, double strictness) {
  return unexplained > usual * (1.0 + (CalibrationMonitor::kDriftRatio - 1.0) * strictness) &&
         unexplained > usual + CalibrationMonitor::kMinDrift * strictness;
}

bool any_jump(const std::vector<double>& turn) {
  return std::any_of(turn.begin(), turn.end(), [](double t) { return t != 0.0; });
}

}  // namespace

class CalibrationMonitor::AccessPoint {
 public:
  AccessPoint(const RoomModel& room, std::size_t index, std::optional<double> usual)
      : index_(index),
        ap_(room.access_points[index]),
        grid_(room.grid),
        arrays_(room, index),
        aligner_(room.grid),
        stated_usual_(usual),
        state_(index, ap_.rx_chains.size(), usual) {}

  void restart() {
    state_ = MonitorState(index_, ap_.rx_chains.size(), stated_usual_);
    for (const auto& point : points_) {
      point->frames.clear();
      point->usual.clear();
      point->settled = false;
    }
  }

  void observe(const Transmitter& transmitter, std::span<const CsiFrame> frames) {
    MonitoredPoint& point = point_of(transmitter);
    std::size_t taken = 0;
    for (const CsiFrame& frame : frames) {
      if (frame.access_point == index_ && taken < kFramesOfBurst) {
        point.frames.push_back(frame);
        ++taken;
      }
    }
    if (taken > 0 && !point.rays.empty() && ++state_.bursts >= kBursts) {
      state_.bursts = 0;
      evaluate(receive());
    }
    if (point.rays.empty()) {
      point.frames.clear();
    }
  }

  const MonitorState& monitor_state() const { return state_; }
  void go_on(const MonitorState& monitor_state) {
    if (monitor_state.jump.size() == ap_.rx_chains.size()) {
      state_ = monitor_state;
    }
  }
  void set_reference(const Transmitter& transmitter, std::vector<Value> array);
  void append_warnings(std::vector<CalibrationWarning>& out) const;

 private:
  MonitoredPoint& point_of(const Transmitter& transmitter);
  ReceivedPoints receive();
  void evaluate(const ReceivedPoints& received);
  std::vector<Value> along(const ReceivedPoint& one) const;
  double correlation(const ReceivedPoints& received, const std::vector<double>& turn) const;
  double correlation(const ReceivedPoints& received, const ArrayMotion& motion) const;
  bool explained_by_motion(const ReceivedPoints& received, double unexplained);
  ArrayMotion scan(const ReceivedPoints& received) const;
  std::vector<double> jumps_of_calibration(const ReceivedPoints& received,
                                           const std::vector<double>& turn) const;
  std::vector<double> jumps(const ReceivedPoints& received);
  CalibrationWarning warning(CalibrationProblem problem) const;

  std::size_t index_;
  RoomAccessPoint ap_;
  OfdmGrid grid_;
  PointArrays arrays_;
  Aligner aligner_;
  std::vector<std::unique_ptr<MonitoredPoint>> points_;
  const std::optional<double> stated_usual_;
  MonitorState state_;
};

MonitoredPoint& CalibrationMonitor::AccessPoint::point_of(const Transmitter& transmitter) {
  for (const auto& point : points_) {
    if (point->transmitter.position == transmitter.position &&
        point->transmitter.device == transmitter.device) {
      return *point;
    }
  }
  auto point = std::make_unique<MonitoredPoint>();
  point->transmitter = transmitter;
  point->rays = arrays_.rays(transmitter.position, transmitter.device);
  point->expected = arrays_.expected(point->rays, ap_.error.plan_tolerance);
  if (!point->rays.empty()) {
    point->known_share = arrays_.known_share(point->rays, ap_.error.plan_tolerance);
    point->sigma = arrays_.place_phase_sigma(
        transmitter.position, transmitter.device, ap_.error.plan_tolerance, kPlaceSigma);
  }
  points_.push_back(std::move(point));
  return *points_.back();
}

void CalibrationMonitor::AccessPoint::set_reference(const Transmitter& transmitter,
                                                    std::vector<Value> array) {
  RAYLOC_CHECK(array.size() == ap_.gains.gain.size());
  MonitoredPoint& point = point_of(transmitter);
  point.expected = std::move(array);
  point.known_share = 1.0;
  point.sigma.assign(ap_.rx_chains.size(), 0.0);
}

ReceivedPoints CalibrationMonitor::AccessPoint::receive() {
  ReceivedPoints received;
  for (const auto& point : points_) {
    auto burst = combine_burst(point->frames, {index_, grid_, ap_.rx_chains, {}});
    point->frames.clear();
    if (burst) {
      remove_gains(ap_.gains, burst->h);
      received.push_back({point.get(), std::move(burst->h)});
    }
  }
  return received;
}

// Projection of each chain's observation on its expectation. The delay of a point is found on the
// chain that fits best: in a sum over chains, phase offsets would cancel.
std::vector<Value> CalibrationMonitor::AccessPoint::along(const ReceivedPoint& one) const {
  const std::size_t tones = grid_.size();
  const std::size_t chains = ap_.rx_chains.size();
  Alignment best;
  for (std::size_t m = 0; m < chains; ++m) {
    const auto alignment = aligner_.align(std::span(one.point->expected).subspan(m * tones, tones),
                                          std::span(one.h).subspan(m * tones, tones));
    best = alignment.correlation > best.correlation ? alignment : best;
  }
  auto h = one.h;
  aligner_.apply(best, h);
  std::vector<Value> phasor(chains);
  for (std::size_t j = 0; j < h.size(); ++j) {
    phasor[j / tones] += h[j] * std::conj(one.point->expected[j]);
  }
  return phasor;
}

double CalibrationMonitor::AccessPoint::correlation(const ReceivedPoints& received,
                                                    const std::vector<double>& turn) const {
  double sum = 0.0;
  for (const ReceivedPoint& one : received) {
    auto h = one.h;
    for (std::size_t j = 0; j < h.size(); ++j) {
      h[j] *= std::polar(1.0, -turn[j / grid_.size()]);
    }
    sum += aligner_.align(one.point->expected, h).correlation;
  }
  return sum / static_cast<double>(received.size());
}

double CalibrationMonitor::AccessPoint::correlation(const ReceivedPoints& received,
                                                    const ArrayMotion& motion) const {
  double sum = 0.0;
  for (const ReceivedPoint& one : received) {
    const auto& all = one.point->rays;
    const std::vector<Ray> strong(
        all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), kScannedRays)));
    sum += aligner_.align(arrays_.expected(strong, ap_.error.plan_tolerance, motion), one.h)
               .correlation;
  }
  return sum / static_cast<double>(received.size());
}

// The best motion on a grid, refined from there with ever smaller steps.
ArrayMotion CalibrationMonitor::AccessPoint::scan(const ReceivedPoints& received) const {
  const int shifts = static_cast<int>(std::lround(kMaxShift / kShiftStep));
  const int yaws = static_cast<int>(std::lround(kMaxYaw / kYawStep));
  std::vector<ArrayMotion> grid;
  for (int yaw = -yaws; yaw <= yaws; ++yaw) {
    for (int x = -shifts; x <= shifts; ++x) {
      for (int y = -shifts; y <= shifts; ++y) {
        grid.push_back({{kShiftStep * x, kShiftStep * y, 0.0}, kYawStep * yaw});
      }
    }
  }
  std::vector<double> fit(grid.size());
  parallel_for(grid.size(), 16, [&](std::size_t i) { fit[i] = correlation(received, grid[i]); });
  const auto most = std::max_element(fit.begin(), fit.end());
  ArrayMotion best = grid[static_cast<std::size_t>(most - fit.begin())];
  double top = *most;
  for (const double step : {0.5, 0.25, 0.125}) {
    for (int round = 0; round < 2; ++round) {
      for (const std::array<double, 3>& direction : {std::array<double, 3>{1, 0, 0},
                                                     {-1, 0, 0},
                                                     {0, 1, 0},
                                                     {0, -1, 0},
                                                     {0, 0, 1},
                                                     {0, 0, -1}}) {
        ArrayMotion next = best;
        next.shift = next.shift + step * kShiftStep * Vec3d{direction[0], direction[1], 0.0};
        next.yaw += step * kYawStep * direction[2];
        if (const double value = correlation(received, next); value > top) {
          best = next;
          top = value;
        }
      }
    }
  }
  return best;
}

// True if a motion leaves much less than `unexplained`: the last one found, or that of a new scan.
bool CalibrationMonitor::AccessPoint::explained_by_motion(const ReceivedPoints& received,
                                                          double unexplained) {
  state_.moved_fit = correlation(received, state_.motion);
  if (1.0 - state_.moved_fit >= kBetter * unexplained && state_.since_scan >= kRescan) {
    state_.since_scan = 0;
    state_.motion = scan(received);
    state_.moved_fit = correlation(received, state_.motion);
  }
  return 1.0 - state_.moved_fit < kBetter * unexplained;
}

// Phase offsets against the calibration that are jumps, 0 for the others: above kJump and three
// sigmas; all 0 where a quarter turn could not be detected.
std::vector<double> CalibrationMonitor::AccessPoint::jumps_of_calibration(
    const ReceivedPoints& received, const std::vector<double>& turn) const {
  const auto points = static_cast<double>(received.size());
  double share = correlation(received, turn);
  for (const ReceivedPoint& one : received) {
    share = std::min(share, one.point->known_share);
  }
  const double misfit = std::sqrt(turn_variance(share) / points);
  std::vector<double> result;
  for (std::size_t m = 0; m < turn.size(); ++m) {
    double sigma = 0.0;
    for (const ReceivedPoint& one : received) {
      sigma = std::hypot(sigma, one.point->sigma[m]);
    }
    const double bound =
        std::hypot(std::clamp(3.0 * sigma / points, kJump, kMaxJumpBound), 3.0 * misfit);
    if (bound >= kQuarterTurn) {
      return std::vector<double>(turn.size());
    }
    result.push_back(std::abs(turn[m]) > bound ? turn[m] : 0.0);
  }
  return result;
}

// Phase jump of each chain, 0 for chains without one: against the calibration, or else against the
// first windows; a jump from before these is then not detected.
std::vector<double> CalibrationMonitor::AccessPoint::jumps(const ReceivedPoints& received) {
  std::vector<std::vector<Value>> phasors;
  ChainTurns turns(ap_.rx_chains.size());
  for (const ReceivedPoint& one : received) {
    phasors.push_back(along(one));
    turns.add(phasors.back());
  }
  std::vector<double> jumped = jumps_of_calibration(received, turns.turns());
  if (any_jump(jumped)) {
    return jumped;
  }
  ChainTurns changes(ap_.rx_chains.size());
  for (std::size_t i = 0; i < received.size(); ++i) {
    settle(*received[i].point, phasors[i]);
    if (received[i].point->settled) {
      for (std::size_t m = 0; m < phasors[i].size(); ++m) {
        phasors[i][m] *= std::conj(received[i].point->usual[m]);
      }
      changes.add(phasors[i]);
    }
  }
  jumped = changes.turns();  // all 0 until a point has settled
  for (double& change : jumped) {
    change = std::abs(change) > kJump ? change : 0.0;
  }
  return jumped;
}

void CalibrationMonitor::AccessPoint::evaluate(const ReceivedPoints& received) {
  if (received.empty()) {
    return;
  }
  const std::vector<double> none(ap_.rx_chains.size());
  state_.fit = correlation(received, none);
  if (!state_.usual) {
    state_.first.push_back(state_.fit);
    if (state_.first.size() >= static_cast<std::size_t>(kSteady)) {
      state_.usual = *std::max_element(state_.first.begin(), state_.first.end());
    }
  }
  ++state_.since_scan;
  const double usual = 1.0 - state_.usual.value_or(state_.fit);
  const bool bad = is_worse(1.0 - state_.fit, usual, 1.0);
  const auto turn = jumps(received);
  const double by_chains = any_jump(turn) ? correlation(received, turn) : state_.fit;
  const bool moved = bad && is_worse(1.0 - by_chains, usual, 1.0) &&
                     explained_by_motion(received, 1.0 - std::max(by_chains, state_.fit));
  for (std::size_t m = 0; m < turn.size(); ++m) {
    const bool now = turn[m] != 0.0 && !moved;
    state_.jump_phase[m] = now ? turn[m] : state_.jump_phase[m];
    state_.jump[m].update(now);
  }
  state_.moved.update(moved);
  const double before = state_.slow.value_or(1.0 - state_.fit);
  state_.slow = before + kSlowness * (1.0 - state_.fit - before);
  state_.drifted = is_worse(*state_.slow, usual, state_.drifted ? 0.5 : 1.0);
}

CalibrationWarning CalibrationMonitor::AccessPoint::warning(CalibrationProblem problem) const {
  CalibrationWarning warning;
  warning.problem = problem;
  warning.access_point = index_;
  warning.fit = state_.fit;
  warning.usual_fit = state_.usual.value_or(state_.fit);
  return warning;
}

void CalibrationMonitor::AccessPoint::append_warnings(std::vector<CalibrationWarning>& out) const {
  const std::string fits = "; the room explains " + percent(state_.fit) + " of it, usually " +
                           percent(state_.usual.value_or(state_.fit));
  bool explained = false;
  for (std::size_t m = 0; m < state_.jump.size(); ++m) {
    if (!state_.jump[m].state()) {
      continue;
    }
    CalibrationWarning one = warning(CalibrationProblem::kChainPhaseJump);
    one.rx_chain = ap_.rx_chains[m];
    one.phase = state_.jump_phase[m];
    one.text = "chain_phase_jump: access point " + ap_.id + ", core " +
               std::to_string(one.rx_chain) + ": its phase has changed by " +
               rounded(one.phase / kDegree) + " degrees" + fits +
               "; after a power cycle run `rayloc calibrate --rechain`";
    out.push_back(std::move(one));
    explained = true;
  }
  if (state_.moved.state()) {
    CalibrationWarning one = warning(CalibrationProblem::kAccessPointMoved);
    one.motion = state_.motion;
    one.text = "access_point_moved: access point " + ap_.id + ": as if shifted by " +
               rounded(100.0 * state_.motion.shift.x) + " cm in x and " +
               rounded(100.0 * state_.motion.shift.y) + " cm in y and rotated by " +
               rounded(state_.motion.yaw / kDegree) + " degrees, which explains " +
               percent(state_.moved_fit) + fits + "; put it back, or calibrate anew";
    out.push_back(std::move(one));
    explained = true;
  }
  if (state_.drifted && !explained) {
    CalibrationWarning one = warning(CalibrationProblem::kResidualDrift);
    one.text = "residual_drift: access point " + ap_.id + ": " +
               percent(state_.slow.value_or(0.0)) +
               " of the CSI it receives from known transmitters is unexplained, usually " +
               percent(1.0 - state_.usual.value_or(state_.fit)) + "; has the room changed?";
    out.push_back(std::move(one));
  }
}

CalibrationMonitor::CalibrationMonitor(std::shared_ptr<const RoomModel> room,
                                       std::vector<std::optional<double>> usual_fit)
    : room_(std::move(room)) {
  RAYLOC_CHECK(room_ != nullptr);
  usual_fit.resize(room_->access_points.size());
  for (std::size_t i = 0; i < room_->access_points.size(); ++i) {
    aps_.push_back(room_->access_points[i].gains.empty()
                       ? nullptr
                       : std::make_unique<AccessPoint>(*room_, i, usual_fit[i]));
  }
}

CalibrationMonitor::~CalibrationMonitor() = default;

void CalibrationMonitor::set_reference(const Transmitter& transmitter,
                                       std::size_t access_point,
                                       std::vector<Value> array) {
  RAYLOC_CHECK(aps_.at(access_point) != nullptr);
  aps_[access_point]->set_reference(transmitter, std::move(array));
}

void CalibrationMonitor::observe(const Transmitter& transmitter, std::span<const CsiFrame> frames) {
  for (const auto& ap : aps_) {
    if (ap != nullptr) {
      ap->observe(transmitter, frames);
    }
  }
}

std::vector<CalibrationMonitor::MonitorState> CalibrationMonitor::monitor_state() const {
  std::vector<MonitorState> all;
  for (const auto& ap : aps_) {
    if (ap != nullptr) {
      all.push_back(ap->monitor_state());
    }
  }
  return all;
}

void CalibrationMonitor::go_on(const std::vector<MonitorState>& monitor_state) {
  for (const MonitorState& one : monitor_state) {
    if (one.access_point < aps_.size() && aps_[one.access_point] != nullptr) {
      aps_[one.access_point]->go_on(one);
    }
  }
}

void CalibrationMonitor::restart() {
  for (const auto& ap : aps_) {
    if (ap != nullptr) {
      ap->restart();
    }
  }
}

std::vector<CalibrationWarning> CalibrationMonitor::warnings() const {
  std::vector<CalibrationWarning> all;
  for (const auto& ap : aps_) {
    if (ap != nullptr) {
      ap->append_warnings(all);
    }
  }
  return all;
}

}  // namespace rayloc
