// Two people at once, on recordings of one:
//
//   people_bench SITE POINTS.csv [AP=]FILE...
//
// SITE: of `rayloc reference`. The change that a person causes in the empty room is independent of
// other people, but for waves that meet both: for pairs of test points the recording of two people
// is made from those of one. Prints how often a second person is detected with one and with two
// people, and the errors of both positions. --verbose: a line for each case.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/fixed_frames.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/survey/points_csv.h"
#include "engine/observe/alignment.h"
#include "engine/person/people.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc::bench {
namespace {

using Frames = std::vector<CsiFrame>;
using Value = std::complex<double>;

struct TestPoint {
  Vec3d position;
  Frames frames;
};

// The channel of a test point's frames, aligned to the empty room; empty if they are too few.
std::vector<Value> aligned(const RoomModel& room, const PersonLink& link, const Frames& frames) {
  std::vector<std::string> warnings;
  auto burst = preprocess_burst(room, link.access_point, frames, {}, warnings);
  if (!burst) {
    return {};
  }
  const Aligner aligner(room.grid);
  aligner.apply(aligner.align(link.empty, burst->h), burst->h);
  return std::move(burst->h);
}

// Frames of `one` with the change that `other` causes in the empty room; empty if CSI is missing.
Frames together(const RoomModel& room,
                const PersonReference& reference,
                const TestPoint& one,
                const TestPoint& other) {
  Frames frames = one.frames;
  for (const PersonLink& link : reference.links) {
    const auto first = aligned(room, link, one.frames);
    const auto second = aligned(room, link, other.frames);
    if (first.empty() || second.empty()) {
      return {};
    }
    const auto& rx_chains = room.access_points[link.access_point].rx_chains;
    for (CsiFrame& frame : frames) {
      if (frame.access_point != link.access_point) {
        continue;
      }
      for (std::size_t m = 0; m < rx_chains.size(); ++m) {
        const auto rx_chain =
            std::find(frame.rx_chains.begin(), frame.rx_chains.end(), rx_chains[m]);
        if (rx_chain == frame.rx_chains.end()) {
          continue;
        }
        const auto row =
            frame.csi.row(static_cast<std::size_t>(rx_chain - frame.rx_chains.begin()), 0);
        for (std::size_t k = 0; k < room.grid.size(); ++k) {
          const auto tone =
              std::find(frame.tone_index.begin(), frame.tone_index.end(), room.grid.tone_index[k]);
          const std::size_t at = m * room.grid.size() + k;
          if (tone != frame.tone_index.end()) {
            row[static_cast<std::size_t>(tone - frame.tone_index.begin())] *=
                std::complex<float>(1.0 + (second[at] - link.empty[at]) / first[at]);
          }
        }
      }
    }
  }
  return frames;
}

double distance(const Vec3d& a, const Vec3d& b) { return std::hypot(a.x - b.x, a.y - b.y); }

void report(const char* what, std::vector<double> values) {
  if (values.empty()) {
    return;
  }
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
  };
  const auto near = std::count_if(values.begin(), values.end(), [](double x) { return x < 0.5; });
  std::printf("%s: n %zu, median %.3f, 90 %% %.3f, below 0.5: %.0f %%\n",
              what,
              values.size(),
              at(0.5),
              at(0.9),
              100.0 * static_cast<double>(near) / static_cast<double>(values.size()));
}

// The errors of the two positions, in the assignment that fits best: the nearer first.
std::pair<double, double> errors(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b) {
  const auto sorted = [](double x, double y) { return std::minmax({x, y}); };
  const auto straight = sorted(distance(p, a), distance(q, b));
  const auto crossed = sorted(distance(p, b), distance(q, a));
  return straight.first + straight.second < crossed.first + crossed.second ? straight : crossed;
}

class Study {
 public:
  Study(const PersonLocalizer& localizer, bool verbose)
      : localizer_(localizer), verbose_(verbose) {}

  // Locates the people of one case, and counts the results.
  void add(const char* name, const std::vector<Vec3d>& truth, const Frames& frames);
  void print(const char* name) const;

 private:
  const PersonLocalizer& localizer_;
  bool verbose_;
  int cases_ = 0;
  int two_seen_ = 0;
  int two_placed_ = 0;
  int regions_ = 0;
  int regions_held_ = 0;  // of 95 %, which hold the one that is nearest
  double seconds_ = 0.0;
  std::vector<double> nearer_;
  std::vector<double> farther_;
};

void Study::add(const char* name, const std::vector<Vec3d>& truth, const Frames& frames) {
  const auto begin = std::chrono::steady_clock::now();
  const auto found = locate_people(localizer_, frames);
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ++cases_;
  two_seen_ += found.size() > 1 ? 1 : 0;
  std::vector<Vec3d> places;
  for (const LocationEstimate& one : found) {
    if (!one.position) {
      continue;
    }
    places.push_back(*one.position);
    double nearest = distance(*one.position, truth.front());
    for (const Vec3d& person : truth) {
      nearest = std::min(nearest, distance(*one.position, person));
    }
    ++regions_;
    regions_held_ += nearest <= one.accuracy_m ? 1 : 0;
  }
  if (truth.size() == 2 && places.size() == 2) {
    const auto [near, far] = errors(places[0], places[1], truth[0], truth[1]);
    ++two_placed_;
    nearer_.push_back(near);
    farther_.push_back(far);
  }
  if (verbose_) {
    const PersonObservation observation = localizer_.receive(frames);
    const double likelihood_exponent = localizer_.reference().person.likelihood_exponent;
    const PersonMap alone = localizer_.map(observation, likelihood_exponent);
    const auto pair = best_pair(localizer_, observation, likelihood_exponent, alone);
    std::printf("%s: %zu found, misfit of one %.2f, gain of two %.1f",
                name,
                found.size(),
                alone.misfit,
                pair ? pair->gain : 0.0);
    if (truth.size() == 2 && places.size() == 2) {
      std::printf(", errors %.3f %.3f", nearer_.back(), farther_.back());
    }
    std::puts("");
  }
}

void Study::print(const char* name) const {
  std::printf(
      "%s: %d cases, two seen in %d and placed in %d, %d of %d regions of 95 %% hold one, "
      "%.0f ms each\n",
      name,
      cases_,
      two_seen_,
      two_placed_,
      regions_held_,
      regions_,
      1e3 * seconds_ / std::max(1, cases_));
  report("  nearer of the two [m]", nearer_);
  report("  farther of the two [m]", farther_);
  std::fflush(stdout);
}

void run(const PersonLocalizer& localizer,
         const std::vector<TestPoint>& test_points,
         bool verbose) {
  Study alone(localizer, verbose);
  for (const TestPoint& test_point : test_points) {
    alone.add("one", {test_point.position}, test_point.frames);
  }
  alone.print("one person");
  constexpr std::size_t kApart = 17;  // in the file, of the test points that make a pair
  constexpr double kMinDistance = 0.5;
  Study two(localizer, verbose);
  for (std::size_t i = 0; i < test_points.size(); ++i) {
    const TestPoint& one = test_points[i];
    const TestPoint& other = test_points[(i + kApart) % test_points.size()];
    if (distance(one.position, other.position) < kMinDistance) {
      continue;
    }
    const Frames frames = together(localizer.room(), localizer.reference(), one, other);
    if (!frames.empty()) {
      two.add("two", {one.position, other.position}, frames);
    }
  }
  two.print("two people");
}

int run(const std::vector<std::string>& arguments, bool verbose) {
  if (arguments.size() < 3) {
    std::fputs("people_bench [--verbose] SITE POINTS.csv [AP=]FILE...\n", stderr);
    return 64;
  }
  const auto fail = [](const Error& error) {
    std::fprintf(stderr, "people_bench: %s\n", error.message.c_str());
    return 65;
  };
  const auto site = load_site(arguments[0]);
  if (!site) {
    return fail(site.error());
  }
  auto room = load_room_model(*site);
  if (!room) {
    return fail(room.error());
  }
  const auto references = load_references(*site, *room);
  if (!references) {
    return fail(references.error());
  }
  std::vector<std::string> ids;
  for (const RoomAccessPoint& ap : room->access_points) {
    ids.push_back(ap.id);
  }
  const auto captures = resolve_captures({arguments.begin() + 2, arguments.end()}, ids);
  if (!captures) {
    return fail(captures.error());
  }
  std::vector<std::string> notes;
  const auto frames = read_fixed_frames(*site, *captures, notes);
  if (!frames) {
    return fail(frames.error());
  }
  const auto points = load_points_csv(arguments[1]);
  if (!points) {
    return fail(points.error());
  }
  const PersonReference& reference = references->front();
  std::vector<TestPoint> test_points;
  for (const SurveyPoint& point : *points) {
    TestPoint test_point{point.position, {}};
    for (const CsiFrame& frame : frames->at(reference.mac)) {
      if (frame.time >= point.t_start && frame.time <= point.t_end) {
        test_point.frames.push_back(frame);
      }
    }
    if (!test_point.frames.empty()) {
      test_points.push_back(std::move(test_point));
    }
  }
  const auto shared = std::make_shared<const RoomModel>(*std::move(room));
  const auto localizer = PersonLocalizer::create(shared, reference, {});
  if (!localizer) {
    return fail(localizer.error());
  }
  run(*localizer, test_points, verbose);
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
