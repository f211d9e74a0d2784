// Shooting and bouncing rays, against the exhaustive search.
#include "engine/trace/images/shooting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "engine/scene/read/load_scene.h"
#include "engine/trace/images/image_tree.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/laboratory.h"
#include "tests/support/office_floor.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::shooting_test {
namespace {

using Sequence = std::vector<std::uint32_t>;

std::set<Sequence> sequences(const MirrorTrie& trie) {
  std::set<Sequence> all;
  std::vector<std::pair<std::uint32_t, Sequence>> open{{MirrorTrie::kRoot, {}}};
  while (!open.empty()) {
    const auto [node, sequence] = open.back();
    open.pop_back();
    const auto [first, surfaces] = trie.children(node);
    for (std::uint32_t i = 0; i < surfaces.size(); ++i) {
      Sequence longer = sequence;
      longer.push_back(surfaces[i]);
      all.insert(longer);
      open.emplace_back(first + i, longer);
    }
  }
  return all;
}

TEST(MirrorTrie, IsASetOfSequences) {
  const std::vector<Sequence> some{{5}, {5, 2}, {5, 2, 9}, {1}, {1, 5}, {5, 0}};
  const auto add = [](MirrorTrie& trie, const Sequence& sequence) {
    std::uint32_t node = MirrorTrie::kRoot;
    for (const std::uint32_t surface : sequence) {
      node = trie.extended(node, surface);
    }
  };
  MirrorTrie forwards;
  MirrorTrie one_half;
  MirrorTrie other_half;
  for (std::size_t i = 0; i < some.size(); ++i) {
    add(forwards, some[i]);
    add(i % 2 == 0 ? one_half : other_half, some[i]);
  }
  other_half.merge(one_half);
  forwards.put_in_order();
  other_half.put_in_order();
  EXPECT_EQ(sequences(forwards), std::set<Sequence>(some.begin(), some.end()));
  EXPECT_EQ(sequences(other_half), sequences(forwards));
  EXPECT_EQ(std::vector(other_half.surfaces().begin(), other_half.surfaces().end()),
            std::vector(forwards.surfaces().begin(), forwards.surfaces().end()));
  EXPECT_EQ(std::vector(forwards.surfaces().begin(), forwards.surfaces().end()),
            (Sequence{1, 5, 5, 0, 2, 9}));
}

TEST(MirrorTrie, GrowsBeyondItsFirstMemory) {
  MirrorTrie trie;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const std::uint32_t node = trie.extended(MirrorTrie::kRoot, 7 * i);
    EXPECT_EQ(trie.extended(node, i), trie.extended(node, i));
  }
  EXPECT_EQ(trie.size(), 10'001U);
}

TEST(Shooting, EmptyRoomGivesEveryPairOfWalls) {
  const auto scene =
      test::make_scene({{"room", test::box_mesh({0, 0, 0}, {5, 4, 3})}}, test::kConcrete);
  const ShotMirrors shot = shoot_mirrors(*scene, {1.0, 1.7, 1.2}, {.max_depth = 2, .rays = 4096});
  EXPECT_EQ(sequences(shot.trie).size(), 6U + 6U * 5U);
  EXPECT_EQ(shot.segments, 2 * 4096U);
}

TEST(Shooting, RaysGoThroughObjectsOnlyWithTransmission) {
  // A pane before a wall.
  const auto scene =
      test::make_scene({{"pane", test::rectangle_mesh({1, -1, -1}, {0, 2, 0}, {0, 0, 2})},
                        {"wall", test::rectangle_mesh({3, -2, -2}, {0, 4, 0}, {0, 0, 4})}},
                       test::kConcrete);
  const auto found = [&](bool transmission) {
    return sequences(shoot_mirrors(*scene,
                                   {0, 0, 0},
                                   {.max_depth = 2, .transmission = transmission, .rays = 4096})
                         .trie);
  };
  EXPECT_EQ(found(false), (std::set<Sequence>{{0}}));
  // Through the pane to the wall are two interactions.
  EXPECT_EQ(found(true), (std::set<Sequence>{{0}, {1}}));
}

TEST(Shooting, NothingIsMetInTheOpen) {
  const auto scene = test::make_scene(
      {{"ground", test::rectangle_mesh({-9, -9, 0}, {18, 0, 0}, {0, 18, 0})}}, test::kConcrete);
  const TraceOptions options{.candidates = CandidateGenerator::kShooting, .rays = 1000};
  EXPECT_EQ(sequences(shoot_mirrors(*scene, {0, 0, 2}, options).trie), (std::set<Sequence>{{0}}));
  EXPECT_EQ(ImageTree(*scene, {0, 0, 2}, options).size(), 1U);
}

// --- Completeness ---------------------------------------------------------------------------

struct Place {
  std::string name;
  std::shared_ptr<const Scene> scene;
  Vec3d access_point;
  std::vector<Vec3d> devices;
};

// So many places 1.2 m above the floor, outside of everything closed.
std::vector<Vec3d> free_places(const Scene& scene,
                               const Vec3d& lower,
                               const Vec3d& upper,
                               std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform;
  std::vector<Vec3d> places;
  while (places.size() < count) {
    const Vec3d place{lower.x + uniform(random) * (upper.x - lower.x),
                      lower.y + uniform(random) * (upper.y - lower.y),
                      1.2};
    const bool free =
        std::all_of(scene.objects().begin(), scene.objects().end(), [&](const SceneObject& object) {
          return std::abs(winding_number(object.mesh, place)) < 0.01;
        });
    if (free) {
      places.push_back(place);
    }
  }
  return places;
}

std::vector<Place> places() {
  auto room = load_scene(test::data_path("/sites/meeting_room/scene.xml"), {test::kCarrier, {}});
  EXPECT_TRUE(room);
  const auto meeting_room = std::make_shared<const Scene>(std::move(*room));
  const auto office = test::office_floor(1000);
  return {{"laboratory",
           test::laboratory(),
           test::laboratory_access_point().pose.position,
           test::laboratory_positions(143)},
          {"meeting room",
           meeting_room,
           {-1.4, 1.05, 1.2},
           free_places(*meeting_room, {-1.5, -1.2, 0}, {1.5, 1.2, 0}, 100)},
          {"office",
           office,
           test::office_access_point(),
           free_places(*office, {0.2, -1.8, 0}, {8, 5, 0}, 100)}};
}

struct Missed {
  std::size_t paths = 0;
  std::size_t of_paths = 0;
  double power = 0.0;  // share
};

// Counts missed paths. Every path that the rays find is one of the exhaustive search, bit for bit.
Missed missed(const Place& place, std::size_t rays) {
  const auto at = [&](CandidateGenerator candidates) {
    const PathTracer tracer(place.scene, {.candidates = candidates, .rays = rays});
    return tracer.at(Receiver{{place.access_point, {}}});
  };
  const ReceiverTracer exhaustive = at(CandidateGenerator::kExhaustive);
  const ReceiverTracer shooting = at(CandidateGenerator::kShooting);
  Missed sum;
  double power = 0.0;
  for (const Vec3d& device : place.devices) {
    const Transmitter transmitter{{device, {}}};
    const Paths all = exhaustive.trace(transmitter);
    const Paths found = shooting.trace(transmitter);
    sum.of_paths += all.size();
    std::size_t next = 0;
    for (const Path& path : all) {
      power += abs2(path.a);
      if (next < found.size() && found[next].tau == path.tau && found[next].a.re == path.a.re &&
          found[next].a.im == path.a.im) {
        ++next;
      } else {
        ++sum.paths;
        sum.power += abs2(path.a);
      }
    }
    EXPECT_EQ(next, found.size()) << "a path that the exhaustive search does not have";
  }
  sum.power /= power;
  return sum;
}

TEST(Shooting, MissesNoPathOfFurnishedRooms) {
  for (const Place& place : places()) {
    const Missed result = missed(place, kDefaultRays);
    EXPECT_EQ(result.paths, 0U) << place.name << ", of " << result.of_paths;
    EXPECT_GT(result.of_paths, 500U);
  }
}

// Prints the table of engine/studies/2026-11-ray-tracer.md.
TEST(Shooting, MissesLittleWithFewRays) {
  for (const Place& place : places()) {
    for (const unsigned bits : {10U, 12U, 14U, 16U}) {
      const Missed result = missed(place, std::size_t{1} << bits);
      const double share = static_cast<double>(result.paths) / static_cast<double>(result.of_paths);
      std::printf("%-12s 2^%u rays: %.2f %% of %zu paths missed, %.4f %% of their power\n",
                  place.name.c_str(),
                  bits,
                  100.0 * share,
                  result.of_paths,
                  100.0 * result.power);
      // Four times the rays miss less than half as much.
      EXPECT_LT(share, 0.25 / std::pow(2.0, 0.5 * (bits - 10.0)));
      EXPECT_LT(result.power, 0.01);
    }
  }
}

TEST(Shooting, MissesNoPathThatGoesThroughPartitions) {
  const Place place = places()[2];
  for (const Vec3d& device : {test::office_device(), test::office_corridor(), {5.9, 2.0, 1.2}}) {
    std::vector<Paths> found;
    for (const auto candidates : {CandidateGenerator::kExhaustive, CandidateGenerator::kShooting}) {
      const PathTracer tracer(place.scene,
                              {.max_depth = 3, .transmission = true, .candidates = candidates});
      found.push_back(tracer.trace(Transmitter{{device, {}}}, Receiver{{place.access_point, {}}}));
    }
    ASSERT_EQ(found[0].size(), found[1].size());
    EXPECT_FALSE(found[0].empty());
  }
}

// --- The choice -----------------------------------------------------------------------------

TEST(CandidateChoice, IsExhaustiveInARoomAndShootingWhereThatIsTooMuch) {
  const auto room = test::laboratory();
  const Vec3d root = test::laboratory_access_point().pose.position;
  EXPECT_EQ(ImageTree(*room, root, {.max_depth = 3}).generator(), CandidateGenerator::kExhaustive);
  EXPECT_EQ(ImageTree(*room, root, {.max_depth = 6, .rays = 4096}).generator(),
            CandidateGenerator::kShooting);
  const auto floor = test::office_floor(20'000);
  EXPECT_EQ(
      ImageTree(*floor, test::office_access_point(), {.max_depth = 3, .rays = 4096}).generator(),
      CandidateGenerator::kShooting);
  EXPECT_EQ(ImageTree(*floor, test::office_access_point(), {.max_depth = 1}).generator(),
            CandidateGenerator::kExhaustive);
}

}  // namespace
}  // namespace rayloc::shooting_test
