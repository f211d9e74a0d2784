// Threads change nothing: neither how many grow a tree, nor how many ask it.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include "engine/base/parallel.h"
#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"
#include "engine/trace/scattering/scattering.h"
#include "tests/support/laboratory.h"
#include "tests/support/office_floor.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::threads_test {
namespace {

// The numbers of all paths of all places, in order.
std::vector<double> numbers(const std::vector<Paths>& links) {
  std::vector<double> all;
  for (const Paths& paths : links) {
    all.push_back(static_cast<double>(paths.size()));
    for (const Path& path : paths) {
      all.insert(all.end(), {path.a.re, path.a.im, path.tau, path.theta_r(), path.phi_t()});
      for (const Interaction& interaction : path.interactions) {
        const Vec3d& at = interaction.position;
        all.insert(all.end(), {static_cast<double>(interaction.surface), at.x, at.y, at.z});
      }
    }
  }
  return all;
}

// The numbers that `work` returns on so many threads.
template <typename Work>
std::vector<double> on_threads(int threads, const Work& work) {
  const tbb::global_control at_least(tbb::global_control::max_allowed_parallelism, 4);
  tbb::task_arena arena(threads);
  std::vector<Paths> links;
  arena.execute([&] { links = work(); });
  return numbers(links);
}

template <typename Work>
void expect_the_same_on_all_threads(std::size_t least, const Work& work) {
  const std::vector<double> one = on_threads(1, work);
  EXPECT_GT(one.size(), least);
  EXPECT_EQ(one, on_threads(2, work));
  EXPECT_EQ(one, on_threads(4, work));
}

std::shared_ptr<const Scene> meeting_room() {
  auto scene = load_scene(test::data_path("/sites/meeting_room/scene.xml"), {test::kCarrier, {}});
  return std::make_shared<const Scene>(std::move(scene).value());
}

// Points of a square of 1 m around `middle`.
std::vector<Vec3d> around(const Vec3d& middle) {
  std::vector<Vec3d> places;
  places.reserve(12);
  for (const double y : {-0.45, 0.0, 0.45}) {
    for (const double x : {-0.45, -0.15, 0.15, 0.45}) {
      places.push_back(middle + Vec3d{x, y, 0.0});
    }
  }
  return places;
}

struct Room {
  std::shared_ptr<const Scene> scene;
  Vec3d antenna;
  std::vector<Vec3d> places;
};

Room room(const std::string& name) {
  if (name == "laboratory") {
    return {test::laboratory(),
            element_position(test::laboratory_access_point(), 0),
            test::laboratory_positions(12)};
  }
  if (name == "office") {
    return {test::office_floor(1000), test::office_access_point(), around(test::office_device())};
  }
  return {meeting_room(), {-1.45, 1.13, 2.25}, around({0.412, 0.5, 1.519})};
}

struct Case {
  const char* name;
  const char* room;
  TraceOptions options;
};

class TraceThreads : public ::testing::TestWithParam<Case> {};

TEST_P(TraceThreads, LeavePathsTheSameBitForBit) {
  expect_the_same_on_all_threads(1000, [&] {
    const Room in = room(GetParam().room);
    const PathTracer tracer(in.scene, GetParam().options);
    const ReceiverTracer at = tracer.at(Receiver{{in.antenna, {}}});
    std::vector<Paths> links(2 * in.places.size());
    parallel_for(links.size(), 1, [&](std::size_t i) {
      links[i] = at.trace(Transmitter{{in.places[i / 2], {}}});  // each place twice
    });
    return links;
  });
}

constexpr auto kExhaustive = CandidateGenerator::kExhaustive;
constexpr auto kShooting = CandidateGenerator::kShooting;

INSTANTIATE_TEST_SUITE_P(
    OfRooms,
    TraceThreads,
    ::testing::Values(
        Case{"laboratory", "laboratory", {.max_depth = 2, .candidates = kExhaustive}},
        Case{"laboratory_shot", "laboratory", {.candidates = kShooting, .rays = 20'000}},
        Case{"laboratory_deep", "laboratory", {.max_depth = 3, .candidates = kExhaustive}},
        Case{"office", "office", {.max_depth = 3}},
        Case{"office_shot", "office", {.candidates = kShooting, .rays = 20'000}},
        Case{"meeting_room_soft", "meeting_room", {.max_depth = 3, .softness = 0.05}},
        Case{"meeting_room_transmission", "meeting_room", {.transmission = true}},
        Case{"meeting_room_both", "meeting_room", {.transmission = true, .softness = 0.05}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(TraceThreadsPastABody, LeavePairsTheSameBitForBit) {
  const Room in = room("meeting_room");
  for (const TargetBody& body : {TargetBody{}, TargetBody{{0.22, 0.15}, 0.4}}) {
    const auto tracer = TargetTracer::create(in.scene, body, {{.max_depth = 2}});
    expect_the_same_on_all_threads(1000, [&] {
      const TargetLink link =
          tracer.value().link(Transmitter{{{0.4, 1.0, 1.5}, {}}}, Receiver{{in.antenna, {}}});
      std::vector<Paths> links(2 * in.places.size());
      parallel_for(links.size(), 1, [&](std::size_t i) {
        const Vec3d& place = in.places[i / 2];
        links[i] = link.trace({place.x, place.y - 0.7}).value();
      });
      return links;
    });
  }
}

// Embree could keep the whole process on one thread.
TEST(TraceThreadsAround, ScenesLeaveTheOtherThreadsAlone) {
  const auto threads = [] {
    return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  };
  const auto all = static_cast<std::size_t>(tbb::info::default_concurrency());
  const auto scene = test::laboratory();
  EXPECT_GE(threads(), all);
  scene->shooter();
  EXPECT_GE(threads(), all);
}

}  // namespace
}  // namespace rayloc::threads_test
