#include "engine/person/calibrate/occupied_room.h"

#include <algorithm>
#include <complex>

#include "engine/observe/alignment.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr int kBackgroundRounds =
    5;  // a count, chosen: the background and the frames nearest to it, in turn
constexpr std::size_t kFramesPerQuiet = 2;  // a count: the quietest one in so many frames is kept

struct Received {
  const CsiFrame* frame;
  std::vector<std::complex<double>> h;
  double correlation = 0.0;  // with the background
};

}  // namespace

std::optional<BurstObservation> receive_background(const RoomModel& room,
                                                   std::size_t access_point,
                                                   std::span<const CsiFrame> frames,
                                                   const BurstOptions& options,
                                                   std::vector<std::string>& warnings) {
  auto background = preprocess_burst(room, access_point, frames, options, warnings);
  std::vector<Received> received;
  for (const CsiFrame& frame : frames) {
    if (frame.access_point != access_point) {
      continue;
    }
    std::vector<std::string> ignored;  // already reported for the whole recording
    if (auto one = preprocess_burst(room, access_point, {&frame, 1}, options, ignored)) {
      received.push_back({&frame, std::move(one->h)});
    }
  }
  const Aligner aligner(room.grid);
  for (int round = 0; round < kBackgroundRounds && background && received.size() > kFramesPerQuiet;
       ++round) {
    for (Received& one : received) {
      one.correlation = aligner.align(background->h, one.h).correlation;
    }
    std::stable_sort(received.begin(), received.end(), [](const Received& a, const Received& b) {
      return a.correlation > b.correlation;
    });
    std::vector<CsiFrame> quiet;
    for (std::size_t i = 0; i < received.size() / kFramesPerQuiet; ++i) {
      quiet.push_back(*received[i].frame);
    }
    background = preprocess_burst(room, access_point, quiet, options, warnings);
  }
  return background;
}

}  // namespace rayloc
