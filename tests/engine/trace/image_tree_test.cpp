// A tree finds the same as a search through all sequences of surfaces, bit for bit.
#include "engine/trace/images/image_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "engine/base/mat3.h"
#include "engine/trace/image_method.h"
#include "engine/trace/interaction_finder.h"
#include "engine/trace/interactions/interaction.h"
#include "engine/trace/path_tracer.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_context.h"
#include "tests/support/scenes.h"

namespace rayloc::image_tree_test {
namespace {

constexpr double kOnPlane = 1e-9;  // [m], as kMinPlaneDistance

// Every chain of mirrors that geometry allows: no beams, no index. Waves that do not go through
// objects stay on the root's side of closed ones, also where a path leads exactly through an edge.
class Exhaustive {
 public:
  enum class Blocked { kLeftOut, kKept };

  Exhaustive(const Scene& scene,
             const Vec3d& root,
             const TraceOptions& options,
             Blocked blocked = Blocked::kLeftOut)
      : scene_(scene), root_(root), options_(options), blocked_(blocked) {}

  std::vector<SpecularChain> chains_to(const Vec3d& target) {
    target_ = target;
    found_.clear();
    if (norm(target - root_) > kOnPlane) {
      add({});
    }
    extend(root_);
    return found_;
  }

 private:
  struct Mirror {
    std::uint32_t surface;
    Vec3d image;
    double image_distance;
  };

  void extend(Vec3d image) {  // by value: mirrors_ grows
    if (mirrors_.size() == static_cast<std::size_t>(options_.max_depth)) {
      return;
    }
    for (std::uint32_t i = 0; i < scene_.surfaces().size(); ++i) {
      const Plane<double>& plane = scene_.surfaces()[i].plane();
      const double d = distance(plane, image);
      if (std::abs(d) < kOnPlane || (!mirrors_.empty() && mirrors_.back().surface == i) ||
          d * root_side(i) < 0.0) {
        continue;
      }
      mirrors_.push_back({i, mirror(plane, image), -d});
      add_if_possible();
      extend(mirrors_.back().image);
      mirrors_.pop_back();
    }
  }

  // +1: that of the normal. Every closed object here is one shell.
  int root_side(std::uint32_t surface) const {
    const std::uint32_t object = scene_.owner(surface).object;
    const Solid& solid = scene_.solid(object);
    if (options_.transmission || solid.shells != 1) {
      return 0;
    }
    const bool is_inside = std::abs(winding_number(scene_.objects()[object].mesh, root_)) > 0.5;
    return is_inside ? -solid.orientation : solid.orientation;
  }

  void add_if_possible() {
    SpecularChain chain;
    Vec3d point = target_;
    for (std::size_t i = mirrors_.size(); i > 0; --i) {
      const Mirror& m = mirrors_[i - 1];
      const Surface& surface = scene_.surfaces()[m.surface];
      const double here = distance(surface.plane(), point);
      if (m.image_distance < 0.0 ? here < kOnPlane : here > -kOnPlane) {
        return;
      }
      point = point + (here / (here - m.image_distance)) * (m.image - point);
      if (!surface.contains(point, options_.softness)) {
        return;
      }
      chain.surfaces.insert(chain.surfaces.begin(), m.surface);
      chain.points.insert(chain.points.begin(), point);
    }
    add(chain);
  }

  // Those that nothing blocks; with transmission those with no more interactions than allowed.
  void add(const SpecularChain& chain) {
    if (blocked_ == Blocked::kKept) {
      found_.push_back(chain);
      return;
    }
    Segment segment{root_, root_, kNoSurface, kNoSurface};
    std::vector<Crossing> crossings;
    std::size_t interactions = chain.surfaces.size();
    for (std::size_t i = 0; i <= chain.points.size(); ++i) {
      const bool last = i == chain.points.size();
      segment.to = last ? target_ : chain.points[i];
      segment.to_surface = last ? kNoSurface : chain.surfaces[i];
      scene_.crossings(segment, crossings);
      interactions += crossings.size();
      if (!options_.transmission && !crossings.empty()) {
        return;
      }
      segment.from = segment.to;
      segment.from_surface = segment.to_surface;
    }
    if (interactions <= static_cast<std::size_t>(options_.max_depth)) {
      found_.push_back(chain);
    }
  }

  const Scene& scene_;
  Vec3d root_;
  TraceOptions options_;
  Blocked blocked_;
  Vec3d target_;
  std::vector<Mirror> mirrors_;
  std::vector<SpecularChain> found_;
};

bool before(const SpecularChain& a, const SpecularChain& b) {
  return a.surfaces.size() != b.surfaces.size() ? a.surfaces.size() < b.surfaces.size()
                                                : a.surfaces < b.surfaces;
}

// In the tree's order: fewer mirrors first, then by their numbers.
void expect_same_chains(std::vector<SpecularChain> expected,
                        const ImageTree& tree,
                        const Vec3d& target) {
  std::sort(expected.begin(), expected.end(), before);
  std::vector<SpecularChain> chains;
  chains.resize(tree.chains_to(target, chains));
  ASSERT_EQ(chains.size(), expected.size());
  for (std::size_t i = 0; i < chains.size(); ++i) {
    EXPECT_EQ(chains[i].surfaces, expected[i].surfaces);
    EXPECT_EQ(chains[i].points, expected[i].points);
  }
}

// A room that a partition nearly divides, with a few boxes in random poses, and a sheet.
std::shared_ptr<const Scene> random_room(std::mt19937& random, int boxes) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<test::NamedMesh> meshes{{"room", test::box_mesh({-3, -2, 0}, {3, 2, 2.5})},
                                      {"partition", test::box_mesh({0.4, -2, 0}, {0.5, 1, 2.5})},
                                      {"sheet",
                                       test::rectangle_mesh({uniform(random), uniform(random), 0.2},
                                                            {uniform(random), 1.3, 0},
                                                            {0, uniform(random), 1.8})}};
  for (int i = 0; i < boxes; ++i) {
    const Vec3d centre{2.5 * uniform(random), 1.5 * uniform(random), 1.2 + uniform(random)};
    Mesh box = test::box_mesh({-0.5, -0.3, -0.4}, {0.5, 0.3, 0.4});
    const Mat3d turn =
        rotation_from_yaw_pitch_roll(3 * uniform(random), uniform(random), uniform(random));
    for (Vec3d& v : box.vertices) {
      v = centre + turn * v;
    }
    meshes.push_back({"box", std::move(box)});
  }
  return test::make_scene(meshes, test::kConcrete);
}

Vec3d random_place(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return {2.9 * uniform(random), 1.9 * uniform(random), 1.25 + 1.2 * uniform(random)};
}

// Roots that share a tree: near each other; one on the other side of a sheet's plane; one within a
// box. Asked often, too.
TEST(ImageTree, GivesEachRootTheChainsOfItsOwnTree) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> nearby(-0.1, 0.1);
  std::size_t compared = 0;
  for (int i = 0; i < 8; ++i) {
    const auto scene = random_room(random, 3);
    const TraceOptions options{.max_depth = i % 4 == 0 ? 3 : 2, .transmission = i % 4 == 3};
    std::vector<Vec3d> roots{random_place(random)};
    while (roots.size() < 5) {
      roots.push_back(roots[0] + Vec3d{nearby(random), nearby(random), nearby(random)});
    }
    const auto shared = ImageTree::shared(*scene, roots, options);
    ASSERT_TRUE(shared);
    for (std::size_t root = 0; root < roots.size(); ++root) {
      const ImageTree own(*scene, roots[root], options);
      for (int j = 0; j < 60; ++j) {
        SCOPED_TRACE("seed 17, room " + std::to_string(i) + ", place " + std::to_string(j));
        const Vec3d target = j % 3 == 0 ? random_place(random) : Vec3d{1.0, 0.5 + 0.001 * j, 1.0};
        std::vector<SpecularChain> expected;
        expected.resize(own.chains_to(target, expected));
        std::vector<SpecularChain> found;
        shared->visit_chains(
            root, target, [&](const SpecularChain& chain) { found.push_back(chain); });
        if (options.transmission) {  // the shared tree may keep chains with too many crossings
          std::erase_if(found, [&](const SpecularChain& chain) {
            return !std::binary_search(expected.begin(), expected.end(), chain, before);
          });
        }
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
          EXPECT_EQ(found[k].surfaces, expected[k].surfaces);
          EXPECT_EQ(found[k].points, expected[k].points);
        }
        compared += found.size();
      }
    }
  }
  EXPECT_GT(compared, 10'000U);
}

// The sheet lies in the plane between the roots: its waves go both ways.
TEST(ImageTree, RootsOnBothSidesOfAMirrorShareATree) {
  const auto scene =
      test::make_scene({{"sheet", test::rectangle_mesh({1, -1, 0}, {2, 0, 0}, {0, 2, 0})},
                        {"wall", test::rectangle_mesh({4, -2, -2}, {0, 4, 0}, {0, 0, 4})}},
                       test::kConcrete);
  const std::vector<Vec3d> roots{{0, 0, 0.05}, {0, 0, -0.05}};
  const TraceOptions options{.max_depth = 2};
  const auto shared = ImageTree::shared(*scene, roots, options);
  ASSERT_TRUE(shared);
  const Vec3d above{3.5, 0.1, 0.06};
  for (std::size_t root = 0; root < 2; ++root) {
    const Vec3d target = root == 0 ? above : Vec3d{above.x, above.y, -above.z};
    std::size_t count = 0;
    shared->visit_chains(root, target, [&](const SpecularChain&) { ++count; });
    std::vector<SpecularChain> own;
    EXPECT_EQ(count, ImageTree(*scene, roots[root], options).chains_to(target, own));
    EXPECT_GE(count, 3U);  // direct, by the sheet, by the wall
  }
}

// Where a tree is asked often it looks closely at what surely is blocked all around.
TEST(ImageTree, FindsTheSameWhereItIsAskedOften) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> nearby(-0.15, 0.15);
  std::size_t compared = 0;
  for (int i = 0; i < 6; ++i) {
    const auto scene = random_room(random, 3);
    const TraceOptions options{.max_depth = 2};
    const Vec3d root = random_place(random);
    const ImageTree tree(*scene, root, options);
    Exhaustive exhaustive(*scene, root, options);
    for (int j = 0; j < 10; ++j) {
      const Vec3d around = random_place(random);
      std::vector<SpecularChain> chains;
      for (int k = 0; k < 8; ++k) {
        for (const double side : {-1.0, 1.0}) {  // all eight cubes that may meet here
          tree.chains_to(around + side * Vec3d{0.1, 0.1, 0.1}, chains);
          tree.chains_to(around + side * Vec3d{-0.1, 0.1, 0.1}, chains);
          tree.chains_to(around + side * Vec3d{0.1, -0.1, 0.1}, chains);
          tree.chains_to(around + side * Vec3d{0.1, 0.1, -0.1}, chains);
        }
      }
      for (int k = 0; k < 40; ++k) {
        SCOPED_TRACE("seed 13, room " + std::to_string(i) + ", place " + std::to_string(j));
        const Vec3d target = around + Vec3d{nearby(random), nearby(random), nearby(random)};
        const auto expected = exhaustive.chains_to(target);
        compared += expected.size();
        expect_same_chains(expected, tree, target);
      }
    }
  }
  EXPECT_GT(compared, 10'000U);
}

TEST(ImageTree, MatchesAnExhaustiveSearch) {
  std::mt19937 random(3);
  std::size_t compared = 0;
  for (int i = 0; i < 20; ++i) {
    const bool deep = i % 4 == 0;
    const auto scene = random_room(random, deep ? 1 : 3);
    const TraceOptions options{.max_depth = deep ? 3 : 2};
    const Vec3d root = random_place(random);
    const ImageTree tree(*scene, root, options);
    Exhaustive exhaustive(*scene, root, options);
    for (int j = 0; j < 20; ++j) {
      SCOPED_TRACE("seed 3, room " + std::to_string(i) + ", place " + std::to_string(j));
      const Vec3d target = random_place(random);
      const auto expected = exhaustive.chains_to(target);
      compared += expected.size();
      expect_same_chains(expected, tree, target);
    }
  }
  EXPECT_GT(compared, 2000U);
}

// Everything on a lattice: points of reflection lie on edges and corners, planes coincide, beams
// have no width.
TEST(ImageTree, FindsTheSameWherePathsMeetEdges) {
  const auto scene =
      test::make_scene({{"room", test::box_mesh({-3, -2, 0}, {3, 2, 3})},
                        {"cupboard", test::box_mesh({1, -2, 0}, {2, -1, 2})},
                        {"shelf", test::box_mesh({-2, 1, 1}, {0, 2, 2})},
                        {"sheet", test::rectangle_mesh({-1, -1, 0}, {1, 0, 0}, {0, 0, 1})}},
                       test::kConcrete);
  const TraceOptions options{.max_depth = 2};
  std::size_t compared = 0;
  for (const Vec3d& root : {Vec3d{0, 0, 1}, Vec3d{2.5, -1.5, 1}, Vec3d{-2, 1, 2.5}}) {
    const ImageTree tree(*scene, root, options);
    Exhaustive exhaustive(*scene, root, options);
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j < 8; ++j) {
        const Vec3d target{-2.75 + 0.5 * i, -1.75 + 0.5 * j, 1.5};
        for (const Vec3d& place : {target, target + Vec3d{0.25, 0.25, 0.5}}) {
          const auto expected = exhaustive.chains_to(place);
          compared += expected.size();
          expect_same_chains(expected, tree, place);
        }
      }
    }
  }
  EXPECT_GT(compared, 2000U);
}

// With transmission the tree may give chains that cross too much, but none may be missing.
TEST(ImageTree, MissesNoChainThatGoesThroughObjects) {
  std::mt19937 random(5);
  std::size_t compared = 0;
  for (int i = 0; i < 6; ++i) {
    const auto scene = random_room(random, 2);
    const TraceOptions options{.max_depth = 3, .transmission = true};
    const Vec3d root = random_place(random);
    const ImageTree tree(*scene, root, options);
    Exhaustive exhaustive(*scene, root, options);
    std::vector<SpecularChain> chains;
    for (int j = 0; j < 4; ++j) {
      const Vec3d target = random_place(random);
      const auto expected = exhaustive.chains_to(target);
      chains.resize(tree.chains_to(target, chains));
      for (const SpecularChain& chain : expected) {
        const auto found = std::lower_bound(chains.begin(), chains.end(), chain, before);
        ASSERT_NE(found, chains.end());
        EXPECT_EQ(found->surfaces, chain.surfaces);
        EXPECT_EQ(found->points, chain.points);
      }
      compared += expected.size();
    }
  }
  EXPECT_GT(compared, 500U);
}

// Between the root and the middle of a small mirror the way crosses x = 2 at y = -0.3; a screen
// there ends at y = `edge`.
std::size_t reflections_past_a_screen(double edge, double softness) {
  const auto scene = test::make_scene(
      {{"mirror", test::rectangle_mesh({4, -0.05, -0.05}, {0, 0.1, 0}, {0, 0, 0.1})},
       {"screen", test::rectangle_mesh({2, -3, -1}, {0, edge + 3, 0}, {0, 0, 2})}},
      test::kConcrete);
  const PathTracer tracer(scene, {.max_depth = 1, .softness = softness});
  const Paths paths = tracer.trace(Transmitter{{{0, 0.6, 0}, {}}}, Receiver{{{0, -0.6, 0}, {}}});
  return static_cast<std::size_t>(std::count_if(paths.begin(), paths.end(), [](const Path& path) {
    return std::any_of(path.interactions.begin(), path.interactions.end(), [](const auto& met) {
      return is_mirror(met.kind);
    });
  }));
}

TEST(ImageTree, KeepsAMirrorThatIsHiddenInPart) {
  EXPECT_EQ(reflections_past_a_screen(-0.301, 0.0), 1U);
  EXPECT_EQ(reflections_past_a_screen(-0.299, 0.0), 0U);
}

TEST(ImageTree, KeepsAMirrorThatASoftEdgeHides) {
  EXPECT_EQ(reflections_past_a_screen(-0.21, 0.0), 0U);
  EXPECT_EQ(reflections_past_a_screen(-0.21, 0.1), 1U);  // 0.09 inside the edge
  EXPECT_EQ(reflections_past_a_screen(-0.1, 0.1), 0U);
}

// With soft edges: what the tree leaves out has no weight.
TEST(ImageTree, OmitsOnlyChainsOfZeroWeight) {
  std::mt19937 random(9);
  std::size_t left_out = 0;
  std::size_t given = 0;
  for (const bool transmission : {false, true, false, true}) {
    const auto scene = random_room(random, 3);
    const TraceOptions options{.max_depth = 2, .transmission = transmission, .softness = 0.1};
    InteractionFinder finder(std::make_shared<const TraceContext>(scene, options));
    const Vec3d root = random_place(random);
    const ImageTree tree(*scene, root, options);
    Exhaustive exhaustive(*scene, root, options, Exhaustive::Blocked::kKept);
    for (int j = 0; j < 30; ++j) {
      const Vec3d target = random_place(random);
      std::vector<SpecularChain> chains;
      chains.resize(tree.chains_to(target, chains));
      given += chains.size();
      for (const SpecularChain& chain : exhaustive.chains_to(target)) {
        if (!std::binary_search(chains.begin(), chains.end(), chain, before)) {
          std::vector<Interaction> interactions;
          const LinkEnd<double> device = link_end(RadioDevice{target, {}});
          const LinkEnd<double> access_point = link_end(RadioDevice{root, {}});
          EXPECT_FALSE(finder.find(chain, device, access_point, interactions));
          ++left_out;
        }
      }
    }
  }
  EXPECT_GT(given, 1000U);
  EXPECT_GT(left_out, 50U);
}

// Far from everything, where floats are coarse, and outside of the scene's bounds.
TEST(ImageTree, FindsTheSameFarFromTheOriginAndOutsideTheScene) {
  const Vec3d shift{4000.0, -2000.0, 1000.0};
  const auto scene =
      test::make_scene({{"wall", test::box_mesh(shift, shift + Vec3d{4, 0.3, 3})},
                        {"floor", test::box_mesh(shift - Vec3d{9, 9, 1}, shift + Vec3d{9, 9, 0})}},
                       test::kConcrete);
  const TraceOptions options{.max_depth = 3};
  const Vec3d root = shift + Vec3d{1.0, -2.0, 1.5};
  const ImageTree tree(*scene, root, options);
  Exhaustive exhaustive(*scene, root, options);
  for (const Vec3d& away :
       {Vec3d{2, -3, 1}, Vec3d{2, 3, 1}, Vec3d{30, -40, 12}, Vec3d{0, 0, 500}, Vec3d{2, -1, -3}}) {
    expect_same_chains(exhaustive.chains_to(shift + away), tree, shift + away);
  }
}

}  // namespace
}  // namespace rayloc::image_tree_test
