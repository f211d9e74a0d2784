#include "engine/baselines/m3/m3_hops.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "engine/base/median.h"
#include "engine/baselines/paths/living_line.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

struct OneHop {
  AntennaLine line;
  OfdmGrid grid;
  BurstObservation burst;
};

// The antennas that are usable on most channels.
const AntennaLine& most_common_line(const std::vector<OneHop>& hops) {
  const auto count = [&](const OneHop& hop) {
    return std::count_if(hops.begin(), hops.end(), [&](const OneHop& other) {
      return other.line.element == hop.line.element;
    });
  };
  return std::max_element(hops.begin(),
                          hops.end(),
                          [&](const OneHop& a, const OneHop& b) { return count(a) < count(b); })
      ->line;
}

BurstObservation summary_of(const std::vector<OneHop>& hops) {
  BurstObservation all = hops.front().burst;
  std::vector<double> snr_db;
  all.frames_used = 0;
  for (const OneHop& hop : hops) {
    all.frames_used += hop.burst.frames_used;
    all.first = std::min(all.first, hop.burst.first);
    all.last = std::max(all.last, hop.burst.last);
    all.motion_residual = std::max(all.motion_residual, hop.burst.motion_residual);
    snr_db.push_back(hop.burst.snr_db);
  }
  all.snr_db = median(std::move(snr_db));
  return all;
}

}  // namespace

std::vector<ChannelFrames> by_channel(const OfdmGrid& site, std::span<const CsiFrame> frames) {
  std::map<double, std::vector<CsiFrame>> channels;  // by centre frequency [Hz]
  for (const CsiFrame& frame : frames) {
    channels[is_on(site, frame) ? site.centre_hz : frame.channel->centre_hz].push_back(frame);
  }
  std::vector<ChannelFrames> all;
  all.reserve(channels.size());
  for (auto& [centre_hz, own] : channels) {
    all.push_back({{centre_hz, site.spacing_hz, site.tone_index}, std::move(own)});
  }
  return all;
}

std::optional<ObservedHops> observe_hops(const RoomModel& room,
                                         std::size_t access_point,
                                         std::span<const ChannelFrames> channels,
                                         std::vector<std::string>& warnings) {
  const RoomAccessPoint& ap = room.access_points[access_point];
  std::vector<OneHop> hops;
  for (const ChannelFrames& channel : channels) {
    std::vector<std::string> problems;
    auto burst = preprocess_burst(room, access_point, channel.frames, {}, problems);
    auto line = burst ? living_line(ap, *burst, problems) : std::nullopt;
    for (std::string& problem : problems) {
      problem +=
          channels.size() == 1
              ? ""
              : " (at " + std::to_string(std::lround(1e-6 * channel.grid.centre_hz)) + " MHz)";
      warnings.push_back(std::move(problem));
    }
    if (line) {
      hops.push_back({*std::move(line), channel.grid, *std::move(burst)});
    }
  }
  if (hops.empty()) {
    return std::nullopt;
  }
  ObservedHops all{{access_point, most_common_line(hops), {}}, {}};
  const std::size_t left_out = std::erase_if(
      hops, [&](const OneHop& hop) { return hop.line.element != all.received.line.element; });
  if (left_out > 0) {
    warnings.push_back("access point " + ap.id + ": " + std::to_string(left_out) + " of " +
                       std::to_string(hops.size() + left_out) +
                       " channels are left out: other antennas are dead there");
  }
  std::vector<std::size_t> tones(room.grid.size());
  std::iota(tones.begin(), tones.end(), std::size_t{0});
  for (const OneHop& hop : hops) {
    all.received.hops.push_back({hop.grid, along(all.received.line, hop.burst, tones)});
  }
  all.burst = summary_of(hops);
  return all;
}

}  // namespace rayloc
