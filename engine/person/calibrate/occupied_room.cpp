#include "engine/person/calibrate/occupied_room.h"

#include <algorithm>
#include <complex>

#include "engine/observe/alignment.h"
#include "engine/room/hear_burst.h"

namespace rayloc {
namespace {

constexpr int kBackgroundRounds =
    5;  // a count, chosen: the background and the frames nearest to it, in turn
constexpr std::size_t kFramesPerQuiet = 2;  // a count: the quietest one in so many frames is kept

struct Heard {
  const CsiFrame* frame;
  std::vector<std::complex<double>> h;
  double correlation = 0.0;  // with the background
};

}  // namespace

std::optional<BurstObservation> hear_background(const RoomModel& room,
                                                std::size_t access_point,
                                                std::span<const CsiFrame> frames,
                                                const BurstOptions& options,
                                                std::vector<std::string>& warnings) {
  auto background = hear(room, access_point, frames, options, warnings);
  std::vector<Heard> heard;
  for (const CsiFrame& frame : frames) {
    if (frame.access_point != static_cast<int>(access_point)) {
      continue;
    }
    std::vector<std::string> ignored;  // already reported for the whole recording
    if (auto one = hear(room, access_point, {&frame, 1}, options, ignored)) {
      heard.push_back({&frame, std::move(one->h)});
    }
  }
  const Aligner aligner(room.grid);
  for (int round = 0; round < kBackgroundRounds && background && heard.size() > kFramesPerQuiet;
       ++round) {
    for (Heard& one : heard) {
      one.correlation = aligner.align(background->h, one.h).correlation;
    }
    std::stable_sort(heard.begin(), heard.end(), [](const Heard& a, const Heard& b) {
      return a.correlation > b.correlation;
    });
    std::vector<CsiFrame> quiet;
    for (std::size_t i = 0; i < heard.size() / kFramesPerQuiet; ++i) {
      quiet.push_back(*heard[i].frame);
    }
    background = hear(room, access_point, quiet, options, warnings);
  }
  return background;
}

}  // namespace rayloc
