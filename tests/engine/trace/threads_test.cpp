// Threads change nothing: neither how many grow a tree, nor how many ask it.
#include <gtest/gtest.h>

#include <vector>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include "engine/base/parallel.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/laboratory.h"

namespace rayloc {
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

std::vector<double> traced(int threads, CandidateGenerator candidates) {
  const tbb::global_control at_least(tbb::global_control::max_allowed_parallelism, 4);
  tbb::task_arena arena(threads);
  std::vector<Paths> links(24);
  arena.execute([&] {
    const PathTracer tracer(test::laboratory(),
                            {.max_depth = 2, .candidates = candidates, .rays = 20'000});
    const auto antennas = array_elements<Receiver>(test::laboratory_access_point());
    const ReceiverTracer at = tracer.at(antennas[0]);
    const auto positions = test::laboratory_positions(links.size());
    parallel_for(links.size(), 1, [&](std::size_t i) {
      links[i] = at.trace(Transmitter{{positions[i / 2], {}}});  // each place twice
    });
  });
  return numbers(links);
}

TEST(TraceThreads, PathsAreTheSameBitForBit) {
  for (const auto candidates : {CandidateGenerator::kExhaustive, CandidateGenerator::kShooting}) {
    const std::vector<double> one = traced(1, candidates);
    EXPECT_GT(one.size(), 4000U);
    EXPECT_EQ(one, traced(2, candidates));
    EXPECT_EQ(one, traced(4, candidates));
  }
}

// Embree could keep the whole process on one thread.
TEST(TraceThreads, ScenesLeaveTheOtherThreadsAlone) {
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
}  // namespace rayloc
