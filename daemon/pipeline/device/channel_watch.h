// ChannelWatch: the last burst of each of a few devices and its location, for clients that display
// the channel behind a position. It is kept only while a client asks for it. Frames and position
// are of the same burst: a walking person is 20 cm further on with the next.
//
// Thread safety: all members from any thread.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/methods/device_capabilities.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

class ChannelWatch {
 public:
  // All frames of one burst and the location computed from it.
  struct Sight {
    std::string target;            // as in topics: no address where outputs hash it
    std::string name;              // for display; may be empty
    Timestamp time;                // of the location
    Vec3d position;                // [m]
    std::vector<CsiFrame> frames;  // all frames that the location was computed from
    std::shared_ptr<const ChannelCapability> channel;  // of the method that computed it
  };

  // True if a sight would be read: until so many have been added since the last question.
  bool is_wanted() const;
  void add(Sight sight);

  // Sights of the last received devices, the latest first; requests more from now on. Empty where
  // no client has asked for so long that the kept sights are outdated.
  std::vector<std::shared_ptr<const Sight>> ask();

  // Discards the kept sights, which are of another time: a recording was moved.
  void clear();

 private:
  mutable std::mutex mutex_;
  std::size_t wanted_ = 0;                          // guarded by mutex_
  std::list<std::shared_ptr<const Sight>> sights_;  // guarded by mutex_; the latest first
};

}  // namespace rayloc
