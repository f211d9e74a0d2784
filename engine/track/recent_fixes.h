// RecentFixes: the positions of a target in the last second, and its velocity as their slope.
#pragma once

#include <deque>
#include <optional>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"

namespace rayloc {

class RecentFixes {
 public:
  // [m], world; later than the ones before.
  void add(Timestamp time, const Vec3d& position);
  // [m/s], of a least-squares line; empty if they span less than half a second.
  std::optional<Vec3d> velocity() const;
  void clear() { fixes_.clear(); }

 private:
  struct Fix {
    Timestamp time;
    Vec3d position;
  };
  std::deque<Fix> fixes_;
};

}  // namespace rayloc
