// Measures how many bursts it takes to learn the receive chains after a power cycle, and the error
// of the learned phases, on recordings of a calibrated site:
//
//   chain_bench [--verbose | --again | --unseen | --calibrated] SITE CYCLES [AP=]FILE...
//
// The transmitter with the most frames is received in bursts of 0.2 s, by each access point
// separately. CYCLES power cycles are made by turning the chains of all frames at random, by any
// phase and by 1.5 dB; the first is the recording as it is. Prints a line for each cycle and access
// point: bursts that counted and seconds until the chains were learned for the first time, how
// often, and the phases learned then and at the end [degrees], without the turns made.
//
// --again: half-way through the recording the access point is off for a minute and comes back with
// other chains (--unseen: without the minute; --calibrated: with the minute, and until then with
// the chains of the recording). Prints after how many bursts the chains used until then are
// withdrawn.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/recorded_frames.h"
#include "daemon/site/model/room_model.h"
#include "engine/chains/chain_learner.h"

namespace rayloc::bench {
namespace {

using Value = std::complex<double>;
using Frames = std::vector<CsiFrame>;

constexpr auto kBurst = std::chrono::milliseconds(200);
constexpr auto kOff = std::chrono::minutes(1);
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kLogGainSigma = 0.17;  // of ln, 1.5 dB

std::vector<Frames> bursts_of(Frames frames) {
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  std::vector<Frames> bursts;
  for (CsiFrame& frame : frames) {
    if (bursts.empty() || frame.time - bursts.back().front().time >= kBurst) {
      bursts.emplace_back();
    }
    bursts.back().push_back(std::move(frame));
  }
  return bursts;
}

void turn(const RoomModel& room, const std::vector<std::vector<Value>>& turns, Frames& frames) {
  for (CsiFrame& frame : frames) {
    const std::size_t a = frame.access_point;
    const auto& rx_chains = room.access_points[a].rx_chains;
    for (std::size_t row = 0; row < frame.rx_chains.size(); ++row) {
      const auto rx_chain = std::find(rx_chains.begin(), rx_chains.end(), frame.rx_chains[row]);
      if (rx_chain == rx_chains.end()) {
        continue;
      }
      const std::complex<float> factor(
          turns[a][static_cast<std::size_t>(rx_chain - rx_chains.begin())]);
      for (std::complex<float>& value : frame.csi.row(row, 0)) {
        value *= factor;
      }
    }
  }
}

// Phase and gain of each chain relative to the first, with the turns that were made taken out.
std::string phases(const std::vector<Value>& factor, const std::vector<Value>& made) {
  std::string text;
  for (std::size_t m = 1; m < factor.size(); ++m) {
    char one[64];
    const Value own = factor[m] / factor[0] / (made[m] / made[0]);
    std::snprintf(one,
                  sizeof one,
                  " %5.0f (%+4.1f dB)",
                  kDegrees * std::arg(own),
                  20.0 * std::log10(std::abs(own)));
    text += one;
  }
  return text;
}

using Turns = std::vector<std::vector<Value>>;  // [access point][chain]

// The turns of a power cycle; the first, number 0, has none.
Turns turns_of(const RoomModel& room, int number, std::mt19937& random) {
  std::uniform_real_distribution<double> around(-std::numbers::pi, std::numbers::pi);
  std::normal_distribution<double> log_gain(0.0, number == 0 ? 0.0 : kLogGainSigma);
  Turns made(room.access_points.size());
  for (std::size_t a = 0; a < made.size(); ++a) {
    for (std::size_t m = 0; m < room.access_points[a].rx_chains.size(); ++m) {
      made[a].push_back(std::polar(std::exp(log_gain(random)), number == 0 ? 0.0 : around(random)));
    }
  }
  return made;
}

void cycle(const std::shared_ptr<const Localizer>& localizer,
           const std::vector<Frames>& bursts,
           int number,
           bool verbose) {
  const RoomModel& room = localizer->room();
  std::mt19937 random(static_cast<unsigned>(number));
  const Turns made = turns_of(room, number, random);
  struct First {
    std::size_t bursts = 0;
    double seconds = 0.0;
    std::string phases;
    int times = 0;
    ChainKnowledge before = ChainKnowledge::kAsCalibrated;
  };
  std::map<std::size_t, First> first;
  std::map<std::size_t, std::size_t> counted;
  ChainLearner learner(localizer);
  const Timestamp start = bursts.front().front().time;
  for (const Frames& burst : bursts) {
    Frames frames = burst;
    turn(room, made, frames);
    const auto began = std::chrono::steady_clock::now();
    learner.receive(frames);
    const double cost =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const double seconds = std::chrono::duration<double>(frames.back().time - start).count();
    for (const ChainState& state : learner.states()) {
      First& one = first[state.access_point];
      if (state.knowledge == ChainKnowledge::kLearned && one.before != ChainKnowledge::kLearned &&
          one.times++ == 0) {
        one.seconds = seconds;
        one.bursts = counted[state.access_point];
        one.phases = phases(state.factors.factor, made[state.access_point]);
      }
      one.before = state.knowledge;
      counted[state.access_point] = state.bursts;
      if (verbose) {
        std::printf("  %6.2f s ap %zu knowledge %d bursts %zu of %zu:%s, %.3f s of work\n",
                    seconds,
                    state.access_point,
                    static_cast<int>(state.knowledge),
                    state.bursts,
                    state.bursts_needed,
                    phases(state.factors.factor, made[state.access_point]).c_str(),
                    cost);
      }
    }
  }
  for (const ChainState& state : learner.states()) {
    const First& one = first[state.access_point];
    std::printf("cycle %d %s: learned %d times, first after %zu bursts, %.1f s:%s; at the end:%s",
                number,
                room.access_points[state.access_point].id.c_str(),
                one.times,
                one.bursts,
                one.seconds,
                one.phases.c_str(),
                phases(state.factors.factor, made[state.access_point]).c_str());
    for (const double sigma : state.factors.sigma) {
      std::printf(" +-%.1f", kDegrees * sigma);
    }
    std::printf(" knowledge %d\n", static_cast<int>(state.knowledge));
  }
  std::fflush(stdout);
}

// The use of an access point's chains from the second power cycle on.
struct Withdrawal {
  bool accepted = false;               // in use when the chains rotated
  std::vector<Value> factor;           // those in use then
  std::optional<std::size_t> bursts;   // since then, until they were withdrawn
  std::optional<std::size_t> learned;  // since then, until others were learned
};

void again(const std::shared_ptr<const Localizer>& localizer,
           const std::vector<Frames>& bursts,
           int number,
           const std::string& option) {
  const RoomModel& room = localizer->room();
  std::mt19937 random(static_cast<unsigned>(number));
  const bool unseen = option == "--unseen";
  const Turns first = turns_of(room, option == "--calibrated" ? 0 : number, random);
  const Turns second = turns_of(room, 1, random);
  ChainLearner learner(localizer);
  std::map<std::size_t, Withdrawal> of;
  const std::size_t half = bursts.size() / 2;
  for (std::size_t n = 0; n < bursts.size(); ++n) {
    if (n == half) {
      for (const ChainState& state : learner.states()) {
        of[state.access_point] = {state.knowledge != ChainKnowledge::kLearning,
                                  state.factors.factor,
                                  std::nullopt,
                                  std::nullopt};
      }
    }
    Frames frames = bursts[n];
    turn(room, n < half ? first : second, frames);
    for (CsiFrame& frame : frames) {
      frame.time += n < half || unseen ? Duration(0) : Duration(kOff);
    }
    learner.receive(frames);
    if (n < half) {
      continue;
    }
    for (const ChainState& state : learner.states()) {
      Withdrawal& one = of[state.access_point];
      const bool same = state.knowledge != ChainKnowledge::kLearning && !one.bursts;
      // A burst that refines factors does not withdraw them.
      double rotated = 0.0;
      for (std::size_t m = 1; same && m < one.factor.size(); ++m) {
        rotated = std::max(rotated,
                           std::abs(std::arg(state.factors.factor[m] / state.factors.factor[0] /
                                             (one.factor[m] / one.factor[0]))));
      }
      if (!one.bursts && (!same || rotated * kDegrees > 45.0)) {
        one.bursts = n - half + 1;
      }
      if (one.bursts && !one.learned && state.knowledge == ChainKnowledge::kLearned) {
        one.learned = n - half + 1;
      }
    }
  }
  const auto text = [](const std::optional<std::size_t>& count) {
    return count ? std::to_string(*count) : std::string("never");
  };
  for (const ChainState& state : learner.states()) {
    const Withdrawal& one = of[state.access_point];
    std::printf(
        "cycle %d %s: %s when turned again; withdrawn after %s bursts, learned anew after %s; at "
        "the end:%s\n",
        number,
        room.access_points[state.access_point].id.c_str(),
        one.accepted ? "accepted" : "not accepted",
        text(one.bursts).c_str(),
        text(one.learned).c_str(),
        phases(state.factors.factor, second[state.access_point]).c_str());
  }
  std::fflush(stdout);
}

int run(const std::vector<std::string>& arguments, const std::string& option) {
  if (arguments.size() < 3) {
    std::fputs(
        "chain_bench [--verbose | --again | --unseen | --calibrated] SITE CYCLES [AP=]FILE...\n",
        stderr);
    return 64;
  }
  const auto site = load_site(arguments[0]);
  const auto room = site ? load_room_model(*site) : tl::make_unexpected(site.error());
  if (!room) {
    std::fprintf(stderr, "chain_bench: %s\n", room.error().message.c_str());
    return 65;
  }
  std::vector<std::string> ids;
  for (const RoomAccessPoint& ap : room->access_points) {
    ids.push_back(ap.id);
  }
  const auto captures =
      resolve_captures({arguments.begin() + 2, arguments.end()}, ids, PerAccessPoint::kSeveral);
  if (!captures) {
    std::fprintf(stderr, "chain_bench: %s\n", captures.error().message.c_str());
    return 65;
  }
  Frames frames;
  std::vector<std::string> notes;
  for (const RecordingArgument& recording : recordings_of(*captures)) {
    const auto read = for_each_frame(
        *site, recording, [&](CsiFrame&& frame) { frames.push_back(std::move(frame)); }, notes);
    if (!read) {
      std::fprintf(stderr, "chain_bench: %s\n", read.error().message.c_str());
      return 65;
    }
  }
  keep_most_received(frames);
  auto made = Localizer::create(std::make_shared<const RoomModel>(*room), {});
  if (!made || frames.empty()) {
    std::fputs("chain_bench: nothing to localize\n", stderr);
    return 65;
  }
  const auto localizer = std::make_shared<const Localizer>(*std::move(made));
  const std::vector<Frames> bursts = bursts_of(std::move(frames));
  for (int number = 0; number < std::atoi(arguments[1].c_str()); ++number) {
    if (option == "--again" || option == "--unseen" || option == "--calibrated") {
      again(localizer, bursts, number, option);
    } else {
      cycle(localizer, bursts, number, option == "--verbose");
    }
  }
  return 0;
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  std::string option;
  if (!arguments.empty() && arguments[0].starts_with("--")) {
    option = arguments[0];
    arguments.erase(arguments.begin());
  }
  return rayloc::bench::run(arguments, option);
}
