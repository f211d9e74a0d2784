// ChannelWatch: the last burst of each of a few devices and where it was located, for those who
// want to see the channel behind a position. Kept only while somebody asks.
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
  struct Sight {
    std::string target;                          // as topics name it: never an address hashed
    Timestamp time;                              // of the last frame
    Vec3d position;                              // [m]
    std::vector<CsiFrame> frames;                // some of the burst
    std::shared_ptr<const Localizer> localizer;  // that located it
  };

  // Whether a sight would be looked at. True until so many have been added since the last question.
  bool is_wanted() const;
  void add(Sight sight);

  // Of the devices heard last, the latest first. From now on more are wanted.
  std::vector<std::shared_ptr<const Sight>> ask();

 private:
  mutable std::mutex mutex_;
  std::size_t wanted_ = 0;                          // guarded by mutex_
  std::list<std::shared_ptr<const Sight>> sights_;  // guarded by mutex_; the latest first
};

}  // namespace rayloc
