// CloudRoom: the parts of a room that the clouds of all its devices share.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/localize/box_lattice.h"
#include "engine/localize/localizer.h"
#include "engine/track/free_space.h"

namespace rayloc {

struct CloudRoom {
  std::shared_ptr<const Localizer> localizer;
  std::shared_ptr<const FreeSpace> space;
  BoxLattice lattice;  // the same for every access point of the room
  struct SampleBox {
    std::uint32_t box = 0;  // of the lattice
    Vec3d middle;           // [m], world
  };
  std::vector<SampleBox> sample;  // kSampleBoxes evenly spread boxes in free cells, always the same
  double boxes = 0.0;             // boxes whose cell is free: a count
};

// Counts, chosen. Boxes that represent the room. Each moment is compared with kBoxesOfMoment of
// them, selected by its time.
inline constexpr std::size_t kSampleBoxes = 256;
inline constexpr std::size_t kBoxesOfMoment = 8;

// Null if the likelihood cannot compare single places: the grid then follows a device.
// REQUIRES: `space` has the grid of the localizer.
std::shared_ptr<const CloudRoom> make_cloud_room(std::shared_ptr<const Localizer> localizer,
                                                 std::shared_ptr<const FreeSpace> space);

}  // namespace rayloc
