#include "tests/support/laboratory.h"

#include <cmath>

#include "engine/base/constants.h"
#include "tests/support/box_scene.h"
#include "tests/support/scenes.h"

namespace rayloc::test {
namespace {

constexpr double kLengthX = 10.8;  // [m]
constexpr double kLengthY = 5.6;
constexpr double kRoomHeight = 3.0;
constexpr double kWall = 0.2;
constexpr double kDeviceHeight = 1.2;
constexpr double kClearance = 0.05;

const std::vector<SceneBox>& boxes() {
  static const std::vector<SceneBox> kBoxes = {
      {"floor", "concrete", {0, 0, -kWall}, {kLengthX, kLengthY, 0}},
      {"ceiling", "ceiling_board", {0, 0, kRoomHeight}, {kLengthX, kLengthY, kRoomHeight + kWall}},
      {"west", "concrete", {-kWall, 0, 0}, {0, kLengthY, kRoomHeight}},
      {"east", "plasterboard", {kLengthX, 0, 0}, {kLengthX + kWall, kLengthY, kRoomHeight}},
      {"south", "concrete", {0, -kWall, 0}, {kLengthX, 0, kRoomHeight}},
      {"north", "plasterboard", {0, kLengthY, 0}, {kLengthX, kLengthY + kWall, kRoomHeight}},
      {"west island", "chipboard", {2.0, 1.9, 0}, {4.6, 3.1, 0.9}},
      {"east island", "chipboard", {5.8, 1.9, 0}, {8.4, 3.1, 0.9}},
      {"west shelf", "wood", {2.0, 2.4, 1.3}, {4.6, 2.6, 1.7}},
      {"east shelf", "wood", {5.8, 2.4, 1.3}, {8.4, 2.6, 1.7}},
      {"fume hood", "metal", {0.05, 0.3, 0.8}, {0.85, 1.8, 2.6}},
      {"cabinet", "metal", {0.05, 2.2, 0}, {0.55, 3.8, 2.0}},
      {"bookcase", "wood", {0.6, 5.2, 0}, {2.4, 5.55, 2.1}},
      {"whiteboard", "metal", {3.0, 5.55, 0.9}, {6.0, 5.58, 2.1}},
      {"north desk", "chipboard", {6.4, 4.8, 0.7}, {8.0, 5.5, 0.75}},
      {"north screen", "glass", {6.9, 5.2, 0.75}, {7.5, 5.25, 1.15}},
      {"east desk", "chipboard", {10.0, 1.0, 0.7}, {10.7, 2.6, 0.75}},
      {"east screen", "glass", {10.4, 1.5, 0.75}, {10.45, 2.1, 1.15}},
      {"rack", "metal", {9.9, 4.7, 0}, {10.6, 5.5, 2.0}},
      {"window", "glass", {3.0, 0.01, 1.0}, {8.0, 0.04, 2.2}},
      {"sideboard", "wood", {3.2, 0.05, 0}, {6.2, 0.5, 0.8}},
      {"door", "wood", {10.76, 3.2, 0}, {10.79, 4.1, 2.05}},
      {"lamp", "metal", {2.0, 1.2, 2.7}, {8.8, 1.35, 2.75}}};
  return kBoxes;
}

}  // namespace

std::shared_ptr<const Scene> laboratory() { return scene_of_boxes(boxes()); }

AntennaArray laboratory_access_point() {
  const double half_wavelength = 0.5 * kSpeedOfLight / kCarrier;
  AntennaArray array;
  array.pose = {{1.2, 4.7, 1.9}, {-0.6, 0.0, 0.0}};
  array.element_offset = {{0, -half_wavelength, 0}, {0, 0, 0}, {0, half_wavelength, 0}};
  array.pattern = AntennaPattern::kHalfWaveDipole;
  return array;
}

std::vector<Vec3d> laboratory_positions(std::size_t count) {
  // Fractional parts of the multiples of two irrational numbers fill a square evenly (the R2
  // sequence: powers of the root of x^3 = x + 1).
  constexpr double kStepX = 0.7548776662466927;
  constexpr double kStepY = 0.5698402909980532;
  std::vector<Vec3d> positions;
  for (std::size_t i = 1; positions.size() < count; ++i) {
    const auto n = static_cast<double>(i);
    const Vec3d position{kLengthX * (n * kStepX - std::floor(n * kStepX)),
                         kLengthY * (n * kStepY - std::floor(n * kStepY)),
                         kDeviceHeight};
    if (is_free(boxes(), position, kClearance)) {
      positions.push_back(position);
    }
  }
  return positions;
}

}  // namespace rayloc::test
