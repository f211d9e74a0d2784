// Measures how a fix reports that something is wrong, on recordings of a calibrated site:
//
//   failure_bench SITE POINTS.csv [AP=]FILE...
//
// Each test point of POINTS is located as recorded, and with one fault: a dead chain, a chain whose
// phase jumped (once for all test points, as by a power cycle, a chain and a state at a time; what
// ChainLearner finds is left out until it is learned, as the daemon does it), an access point in
// NLOS (97 % of the amplitude of its line of sight taken out, as the calibrated room has it), a
// device outside of the area (the bounds end 0.3 m short of it), and the channel of another room.
// Prints a line for each case and number of access points: cases, NO_FIX, fixes with a warning, and
// those whose stated region of 95 % excludes the truth. --verbose: a line for each fix.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/calibration_inputs.h"
#include "daemon/site/model/room_model.h"
#include "engine/chains/chain_learner.h"
#include "engine/localize/localizer.h"
#include "engine/posterior/credible_region.h"
#include "tests/support/faulty_frames.h"

namespace rayloc::bench {
namespace {

using Frames = std::vector<CsiFrame>;
using Value = std::complex<double>;

struct TestPoint {
  Vec3d position;
  Frames frames;
};

struct Tally {
  int cases = 0;
  int no_fix = 0;
  int warned = 0;
  int wrong = 0;
  int wrong_unwarned = 0;
};

void strange(const RoomModel& room, std::mt19937& random, Frames& frames) {
  std::vector<std::vector<Value>> channels(room.access_points.size());
  std::normal_distribution<float> normal;
  for (CsiFrame& frame : frames) {
    std::vector<double> offset;
    for (const std::int16_t tone : frame.tone_index) {
      offset.push_back(room.grid.spacing_hz * tone);
    }
    auto& h = channels[frame.access_point];
    if (h.empty()) {
      h = test::strange_channel(frame.rx_chains.size(), offset, random);
    }
    for (std::size_t m = 0; m < frame.rx_chains.size(); ++m) {
      const auto row = frame.csi.row(m, 0);
      for (std::size_t k = 0; k < row.size(); ++k) {
        const float real = 0.1F * normal(random);
        row[k] = std::complex<float>(h[m * row.size() + k]) +
                 std::complex<float>(real, 0.1F * normal(random));
      }
    }
  }
}

void judge(bool verbose,
           const std::string& name,
           const Localizer& localizer,
           const TestPoint& test_point,
           const Frames& frames,
           Tally& tally,
           bool named = false) {
  const LocationEstimate estimate = localizer.locate(frames);
  ++tally.cases;
  const bool warned = named || !estimate.warnings.empty();
  double error = -1.0;
  double reaching = 0.0;
  if (estimate.position) {
    error = std::hypot(estimate.position->x - test_point.position.x,
                       estimate.position->y - test_point.position.y);
    reaching = region_reaching(estimate, test_point.position).value_or(1.0);
    tally.warned += warned ? 1 : 0;
    tally.wrong += reaching > 0.95 ? 1 : 0;
    tally.wrong_unwarned += reaching > 0.95 && !warned ? 1 : 0;
  } else {
    ++tally.no_fix;
  }
  if (verbose) {
    std::printf("%s aps %zu error %.3f accuracy %.3f reaching %.3f residual %.4f loss %.2f",
                name.c_str(),
                localizer.room().access_points.size(),
                error,
                estimate.accuracy_m,
                reaching,
                estimate.residual_probability,
                estimate.loss);
    const RoomObservation observation = localizer.receive(frames);
    for (const ArrayObservation& received : observation.arrays) {
      double weakest = 1e9;
      const std::size_t tones = localizer.room().grid.size();
      for (std::size_t m = 0; m < received.h.size() / tones; ++m) {
        double own = 0.0;
        double others = 0.0;
        for (std::size_t j = 0; j < received.h.size(); ++j) {
          (j / tones == m ? own : others) += std::norm(received.h[j]);
        }
        weakest = std::min(weakest, 2.0 * own / others);
      }
      std::printf(" | weakest %.1f dB", 10.0 * std::log10(weakest));
    }
    std::printf(" %s\n", !estimate.warnings.empty() ? estimate.warnings.front().c_str() : "");
  }
}

// One half of the room, seen from a test point of the other.
RoomModel half(RoomModel room, bool upper) {
  const bool along_x =
      room.bounds_max.x - room.bounds_min.x > room.bounds_max.y - room.bounds_min.y;
  double& low = along_x ? room.bounds_min.x : room.bounds_min.y;
  double& high = along_x ? room.bounds_max.x : room.bounds_max.y;
  const double middle = 0.5 * (low + high);
  (upper ? low : high) = middle;
  return room;
}

bool is_outside(const RoomModel& room, const Vec3d& p) {
  constexpr double kMargin = 0.3;
  return p.x < room.bounds_min.x - kMargin || p.x > room.bounds_max.x + kMargin ||
         p.y < room.bounds_min.y - kMargin || p.y > room.bounds_max.y + kMargin;
}

void print(const std::string& name, const RoomModel& room, const Tally& tally) {
  std::printf("| %s | %zu | %d | %d | %d | %d (%.0f %%) | %d |\n",
              name.c_str(),
              room.access_points.size(),
              tally.cases,
              tally.no_fix,
              tally.warned,
              tally.wrong,
              100.0 * tally.wrong / std::max(1, tally.cases),
              tally.wrong_unwarned);
  std::fflush(stdout);
}

// Every chain of every access point in turn, through all test points.
void study_jumps(const std::shared_ptr<const Localizer>& localizer,
                 const std::vector<TestPoint>& test_points,
                 bool verbose) {
  const RoomModel& room = localizer->room();
  Tally tally;
  int quarters = 0;
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    for (const std::uint8_t rx_chain : room.access_points[ap].rx_chains) {
      quarters = quarters % 3 + 1;
      ChainLearner learner(localizer);
      for (const TestPoint& test_point : test_points) {
        Frames frames = test_point.frames;
        test::turn_chain(
            frames, ap, rx_chain, 0.5 * std::numbers::pi * static_cast<double>(quarters));
        learner.receive(frames);
        judge(verbose,
              "chain's phase jumped",
              *localizer,
              test_point,
              learner.accepted(frames),
              tally,
              !learner.leaves_alone());
      }
    }
  }
  print("chain's phase jumped", room, tally);
}

void run(const RoomModel& room, const std::vector<TestPoint>& test_points, bool verbose) {
  const auto shared = std::make_shared<const RoomModel>(room);
  const auto kept = std::make_shared<const Localizer>(*Localizer::create(shared, {}));
  const Localizer& localizer = *kept;
  const auto study = [&](const std::string& name,
                         const Localizer& by,
                         const std::function<bool(std::size_t, Frames&)>& spoil) {
    Tally tally;
    for (std::size_t i = 0; i < test_points.size(); ++i) {
      Frames frames = test_points[i].frames;
      if (spoil(i, frames)) {
        judge(verbose, name, by, test_points[i], frames, tally);
      }
    }
    print(name, room, tally);
  };
  std::mt19937 random(1);
  const std::size_t aps = room.access_points.size();
  const auto hit = [&](std::size_t i) { return i % aps; };
  const auto rx_chain = [&](std::size_t i) {
    const auto& rx_chains = room.access_points[i % aps].rx_chains;
    return rx_chains[(i / aps) % rx_chains.size()];
  };
  study("as recorded", localizer, [](std::size_t, Frames&) { return true; });
  study("chain dead", localizer, [&](std::size_t i, Frames& frames) {
    test::kill_chain(frames, hit(i), rx_chain(i), random);
    return true;
  });
  study_jumps(kept, test_points, verbose);
  study("access point covered", localizer, [&](std::size_t i, Frames& frames) {
    test::obstruct(frames, hit(i), room, test_points[i].position);
    return true;
  });
  study("another room's channel", localizer, [&](std::size_t, Frames& frames) {
    strange(room, random, frames);
    return true;
  });
  for (const bool upper : {false, true}) {
    const auto part = std::make_shared<const RoomModel>(half(room, upper));
    const Localizer by = *Localizer::create(part, {});
    study("outside of the area", by, [&](std::size_t i, Frames&) {
      return is_outside(*part, test_points[i].position);
    });
  }
}

int run(const std::vector<std::string>& arguments, bool verbose) {
  if (arguments.size() < 3) {
    std::fputs("failure_bench [--verbose] SITE POINTS.csv [AP=]FILE...\n", stderr);
    return 64;
  }
  const auto site = load_site(arguments[0]);
  const auto room = site ? load_room_model(*site) : tl::make_unexpected(site.error());
  if (!room) {
    std::fprintf(stderr, "failure_bench: %s\n", room.error().message.c_str());
    return 65;
  }
  std::vector<std::string> ids;
  for (const RoomAccessPoint& ap : room->access_points) {
    ids.push_back(ap.id);
  }
  const auto captures = resolve_captures({arguments.begin() + 2, arguments.end()}, ids);
  const auto inputs = captures ? read_calibration_inputs(*site, *captures, arguments[1])
                               : tl::make_unexpected(captures.error());
  if (!inputs) {
    std::fprintf(stderr, "failure_bench: %s\n", inputs.error().message.c_str());
    return 65;
  }
  std::vector<TestPoint> test_points;
  for (const SurveyedFrames& one : inputs->points) {
    if (!one.frames.empty()) {
      test_points.push_back({one.point.position, one.frames});
    }
  }
  std::puts("| case | access points | n | NO_FIX | warned | wrong | wrong, no warning |");
  std::puts("|---|---|---|---|---|---|---|");
  run(*room, test_points, verbose);
  return 0;
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool verbose = !arguments.empty() && arguments[0] == "--verbose";
  if (verbose) {
    arguments.erase(arguments.begin());
  }
  return rayloc::bench::run(arguments, verbose);
}
