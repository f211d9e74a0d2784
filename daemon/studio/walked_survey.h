// WalkedSurvey: a survey that is walked with the map in the hand: tap where you stand, frames are
// counted by raylocd, next. Points go to the csv that `rayloc calibrate --points` reads.
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

  // `frames`: asked for when somebody asks for a state.
  WalkedSurvey(std::filesystem::path file, std::function<Frames()> frames)
      : file_(std::move(file)), frames_(std::move(frames)) {}

  // "file", "points" ([x, y, z] each), and while somebody stands: "standing" with "position",
  // "seconds" and "frames" since then.
  Expected<nlohmann::ordered_json> state() const;
  // Somebody stands there from now on; it takes the place of where he stood before.
  Expected<void> stand(const Vec3d& position);
  // He has stood there long enough: the point is written. An Error where he stands nowhere or
  // nothing was heard.
  Expected<void> keep();
  void leave() { standing_.reset(); }

 private:
  struct Standing {
    Vec3d position;
    Timestamp since;
    Frames frames;  // then
  };

  Frames heard() const;  // since he stands there

  std::filesystem::path file_;
  std::function<Frames()> frames_;
  std::optional<Standing> standing_;
};

}  // namespace rayloc
