// ChannelWatch: the last burst of each of a few devices and where it was located, for those who
// want to see the channel behind a position. Kept only while somebody asks. Frames and position
// are of the same burst: a person who walks is 20 cm further on with the next.
//
// Thread safety: all members from any thread.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"

namespace rayloc {

class ChannelWatch {
 public:
  // All of one burst and of the one location that was made of it.
  struct Sight {
    std::string target;                          // as topics name it: never an address hashed
    std::string name;                            // for people; may be empty
    Timestamp time;                              // of the location
    Vec3d position;                              // [m]
    std::vector<CsiFrame> frames;                // all that it was located by
    std::shared_ptr<const Localizer> localizer;  // that located it
  };

  // Whether a sight would be looked at. True until so many have been added since the last question.
  bool is_wanted() const;
  void add(Sight sight);

  // Of the devices heard last, the latest first. From now on more are wanted. Nothing where nobody
  // has asked for so long that what was kept is of another time.
  std::vector<std::shared_ptr<const Sight>> ask();

  // What was kept is of another time: a recording was moved.
  void clear();

 private:
  mutable std::mutex mutex_;
  std::size_t wanted_ = 0;                          // guarded by mutex_
  std::list<std::shared_ptr<const Sight>> sights_;  // guarded by mutex_; the latest first
};

}  // namespace rayloc
