// PathGrid: the rays from every cell of a room to one access point: the part of a Localizer that is
// traced, and worth keeping from one start of a program to the next.
//
// They depend on the room alone, so they are kept under a hash of all of it (METHODS B3). The
// engine reads no files: a PathGridStore does (daemon/site/path_grid_files.h).
//
// What a store gives back is believed only after a sample of the cells has been traced again and is
// the same to the bit. So neither a change of the program nor another type of processor can put old
// rays beside new ones, and a Localizer is the same with a store and without.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/posterior/posterior.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"

namespace rayloc {

using PathGrid = std::vector<std::vector<Ray>>;  // [cell][ray]

class PathGridStore {
 public:
  virtual ~PathGridStore() = default;
  // The bytes that were saved last under `key`, whole; nothing where there are none.
  virtual std::optional<std::string> load(const std::string& key) = 0;
  // May fail: then they are not there the next time.
  virtual void save(const std::string& key, std::string_view bytes) = 0;
  // The bytes of `key` were no grid that this program would make.
  virtual void refuse(const std::string& key) = 0;
};

// A hash of everything that the rays of an access point of the room depend on, as text.
std::string path_grid_key(const RoomModel& room,
                          const RoomAccessPoint& access_point,
                          const RoomGrid& grid,
                          std::size_t most_rays);

struct PathGridSource {
  std::size_t cells = 0;
  std::function<std::vector<Ray>(std::size_t cell)> trace;  // from any thread
};

// Of the store where it has them, else traced and saved there. `store` may be null.
PathGrid make_path_grid(const PathGridSource& source, const std::string& key, PathGridStore* store);

// To the bit.
bool is_same(const PathGrid& a, const PathGrid& b);

// As a store keeps them: for programs of this build on this machine.
std::string to_bytes(const PathGrid& grid);
std::optional<PathGrid> parse_path_grid(std::string_view bytes);

}  // namespace rayloc
