// PathGrid: the rays from every cell of a room to one access point: the traced part of a Localizer,
// stored from one start of a program to the next.
//
// The rays depend on the room only, so they are stored under a hash of it (METHODS B3). The engine
// reads no files; a PathGridStore does (daemon/site/model/path_grid_files.h).
//
// Stored rays are accepted only after a sample of the cells has been traced again and is identical
// to the bit. So neither a change of the program nor another type of processor can mix old rays
// with new ones, and a Localizer is the same with a store and without.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/grid/grid.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"

namespace rayloc {

using PathGrid = std::vector<std::vector<Ray>>;  // [cell][ray]

class PathGridStore {
 public:
  virtual ~PathGridStore() = default;
  // The complete bytes last saved under `key`; empty if there are none.
  virtual std::optional<std::string> load(const std::string& key) = 0;
  // May fail: the bytes are then missing at the next start.
  virtual void save(const std::string& key, std::string_view bytes) = 0;
  // Reports that the bytes of `key` are not a grid that this program would make.
  virtual void refuse(const std::string& key) = 0;
};

// A hash, as text, of all inputs of the rays of an access point of the room.
std::string path_grid_key(const RoomModel& room,
                          const RoomAccessPoint& access_point,
                          const Grid& grid,
                          std::size_t most_rays);

struct PathGridSource {
  std::size_t cells = 0;
  std::function<std::vector<Ray>(std::size_t cell)> trace;  // callable from any thread
};

// Loads the grid from the store, or traces and saves it. `store` may be null.
PathGrid make_path_grid(const PathGridSource& source, const std::string& key, PathGridStore* store);

// Comparison to the bit.
bool is_same(const PathGrid& a, const PathGrid& b);

// Storage format, valid for programs of this build on this machine.
std::string to_bytes(const PathGrid& grid);
std::optional<PathGrid> parse_path_grid(std::string_view bytes);

}  // namespace rayloc
