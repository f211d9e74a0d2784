#include "engine/monitor/chain_watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "engine/posterior/access_point_fusion.h"

namespace rayloc {
namespace {

constexpr double kPrior = 1e-3;         // that chains have turned when nothing was heard yet
constexpr double kLeastLogOdds = -9.0;  // of log odds: a turn that comes later is found as soon
constexpr double kMostLogOdds = 20.0;   // of log odds
constexpr double kMostOfBurst = 4;      // of one burst: of a device that moves it is of no place
constexpr double kLeastEvidence = 3.0;  // of a burst that the room explains, in one state at least
constexpr double kSameCorrelation = 0.9;  // correlation of bursts that say the same
// A count of bursts, chosen: a burst like one of them tells nothing new.
constexpr std::size_t kRemembered = 24;
constexpr std::size_t kLeastBursts = 5;  // before it is settled
constexpr std::size_t kMostCores = 3;    // whose states are tried together
// [s], chosen: between looks while it is open.
constexpr auto kUnsettledPeriod = std::chrono::seconds(1);
// [s], chosen: between looks once it is known.
constexpr auto kSettledPeriod = std::chrono::seconds(10);
constexpr int kQuarters = 4;  // a count: quarters of a turn, the states a chain can start in

// Quarters by which each chain but the first is turned, for every state but that of the
// calibration: all of three cores, of more each core alone.
std::vector<std::vector<int>> states_of(std::size_t cores) {
  std::vector<std::vector<int>> states;
  if (cores < 2) {
    return states;
  }
  if (cores > kMostCores) {
    for (std::size_t core = 1; core < cores; ++core) {
      for (int quarter = 1; quarter < kQuarters; ++quarter) {
        states.emplace_back(cores, 0)[core] = quarter;
      }
    }
    return states;
  }
  int count = 1;
  for (std::size_t core = 1; core < cores; ++core) {
    count *= kQuarters;
  }
  for (int state = 1; state < count; ++state) {
    std::vector<int>& quarters = states.emplace_back(cores, 0);
    int left = state;
    for (std::size_t core = 1; core < cores; ++core, left /= kQuarters) {
      quarters[core] = left % kQuarters;
    }
  }
  return states;
}

// What would have been heard if the chains had not turned by so much.
HeardArray turned_back(const HeardArray& heard, const std::vector<int>& quarters) {
  HeardArray turned = heard;
  const std::size_t tones = turned.h.size() / quarters.size();
  for (std::size_t core = 0; core < quarters.size(); ++core) {
    const auto turn = std::polar(1.0, -0.5 * std::numbers::pi * quarters[core]);
    for (std::size_t k = 0; k < tones; ++k) {
      turned.h[core * tones + k] *= turn;
    }
  }
  turned.observed = turned.map->observe(turned.h, heard.observed.array.noise);
  return turned;
}

}  // namespace

ChainWatch::ChainWatch(std::shared_ptr<const Localizer> localizer)
    : localizer_(std::move(localizer)), aligner_(localizer_->room().grid) {}

double ChainWatch::AccessPoint::probability() const {
  double odds = 0.0;
  for (const double one : log_odds) {
    odds += std::exp(one);
  }
  return odds / (1.0 + odds);
}

bool ChainWatch::AccessPoint::is_settled() const {
  return bursts >= kLeastBursts && probability() < kPrior;
}

bool ChainWatch::is_due(std::size_t access_point, Timestamp time) const {
  const auto found = aps_.find(access_point);
  return found == aps_.end() ||
         time - found->second.last >=
             (found->second.is_settled() ? Duration(kSettledPeriod) : Duration(kUnsettledPeriod));
}

bool ChainWatch::is_new(const AccessPoint& ap, const Array& h) const {
  return std::none_of(ap.heard.begin(), ap.heard.end(), [&](const Array& before) {
    return before.size() == h.size() && aligner_.align(before, h).correlation > kSameCorrelation;
  });
}

double ChainWatch::log_evidence(const HeardArray& heard) const {
  const Localizer::Evidence evidence = localizer_->evidence({{heard}, {}});
  return evidence.log_likelihood.empty()
             ? 0.0
             : log_mean_exp(evidence.log_likelihood, localizer_->room().likelihood_exponent);
}

void ChainWatch::weigh(const HeardArray& heard, AccessPoint& ap) const {
  const auto states = states_of(heard.map->antennas());
  const double as_calibrated = log_evidence(heard);
  double best = as_calibrated;
  std::vector<double> of_state;
  for (const std::vector<int>& quarters : states) {
    of_state.push_back(log_evidence(turned_back(heard, quarters)));
    best = std::max(best, of_state.back());
  }
  if (best < kLeastEvidence) {
    return;
  }
  if (ap.log_odds.empty()) {
    ap.log_odds.assign(states.size(), std::log(kPrior / static_cast<double>(states.size())));
  }
  for (std::size_t v = 0; v < states.size(); ++v) {
    const double gain = std::clamp(of_state[v] - as_calibrated, -kMostOfBurst, kMostOfBurst);
    ap.log_odds[v] = std::clamp(ap.log_odds[v] + gain, kLeastLogOdds, kMostLogOdds);
  }
  ++ap.bursts;
  if (ap.heard.size() < kRemembered) {
    ap.heard.push_back(heard.h);
  } else {
    ap.heard[ap.next] = heard.h;
    ap.next = (ap.next + 1) % kRemembered;
  }
}

void ChainWatch::hear(std::span<const CsiFrame> frames) {
  if (frames.empty()) {
    return;
  }
  const Timestamp time = frames.back().time;
  const std::vector<RoomAccessPoint>& access_points = localizer_->room().access_points;
  std::vector<char> due(access_points.size());
  for (const CsiFrame& frame : frames) {
    const auto a = static_cast<std::size_t>(frame.access_point);
    due[a] = is_due(a, time) ? 1 : 0;
  }
  if (std::find(due.begin(), due.end(), 1) == due.end()) {
    return;
  }
  const RoomObservation observation = localizer_->hear(frames);
  for (const HeardArray& heard : observation.arrays) {
    const auto a = static_cast<std::size_t>(
        std::find_if(access_points.begin(),
                     access_points.end(),
                     [&](const auto& one) { return one.id == heard.map->access_point().id; }) -
        access_points.begin());
    // Without a chain that is dead the states are others.
    if (due[a] == 0 || heard.map->antennas() != access_points[a].cores.size()) {
      continue;
    }
    AccessPoint& ap = aps_[a];
    ap.last = time;
    if (is_new(ap, heard.h)) {
      weigh(heard, ap);
    }
  }
}

std::vector<CsiFrame> ChainWatch::believed(std::span<const CsiFrame> frames,
                                           std::span<const Turn> turned) {
  std::vector<CsiFrame> kept;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(kept), [&](const CsiFrame& frame) {
    return std::none_of(turned.begin(), turned.end(), [&](const Turn& turn) {
      return turn.access_point == static_cast<std::size_t>(frame.access_point);
    });
  });
  return kept;
}

std::vector<ChainWatch::Turn> ChainWatch::turned() const {
  std::vector<Turn> result;
  for (const auto& [access_point, ap] : aps_) {
    const double probability = ap.probability();
    if (probability < kSure) {
      continue;
    }
    const auto best = static_cast<std::size_t>(
        std::max_element(ap.log_odds.begin(), ap.log_odds.end()) - ap.log_odds.begin());
    Turn turn{access_point, {}, probability, ap.bursts};
    const auto states = states_of(localizer_->room().access_points[access_point].cores.size());
    for (const int quarters : states[best]) {
      turn.phase.push_back(0.5 * std::numbers::pi * (quarters > 2 ? quarters - 4 : quarters));
    }
    result.push_back(std::move(turn));
  }
  return result;
}

}  // namespace rayloc
