// WalkedSurvey: a survey made on foot with the map: the person taps their position, raylocd
// counts frames, then the next point. Points go to the csv that `rayloc calibrate --points` reads.
//
// Thread safety: one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json_fwd.hpp>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"

namespace rayloc {

class WalkedSurvey {
 public:
  using Frames = std::map<std::string, std::uint64_t>;  // since the start, by access point

  // `frames`: called when a state is requested.
  WalkedSurvey(std::filesystem::path file, std::function<Frames()> frames)
      : file_(std::move(file)), frames_(std::move(frames)) {}

  // "file", "points" ([x, y, z] each), and while a person is at a point: "standing" with
  // "position", "seconds" and "frames" since then.
  Expected<nlohmann::ordered_json> state() const;
  // The position of the person from now on; replaces the previous one.
  Expected<void> begin_stay(const Vec3d& position);
  // Ends the stay: the point is written. Returns an Error
  // if no position is set or no frame was received.
  Expected<void> keep();
  void leave() { stay_.reset(); }

 private:
  struct Stay {
    Vec3d position;
    Timestamp since;
    Frames frames;  // frame counts then
  };

  Frames received() const;  // since the beginning of the stay

  std::filesystem::path file_;
  std::function<Frames()> frames_;
  std::optional<Stay> stay_;
};

}  // namespace rayloc
