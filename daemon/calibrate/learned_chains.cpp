#include "daemon/calibrate/learned_chains.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "daemon/recordings/recorded_frames.h"
#include "daemon/site/room_model.h"
#include "engine/chains/chain_learner.h"
#include "engine/localize/localizer.h"

namespace rayloc::cli {
namespace {

constexpr auto kBurst = std::chrono::milliseconds(200);  // as of a device that raylocd tracks

// Frames of one transmitter that belong together.
using Frames = std::vector<CsiFrame>;

bool is_device(const Site& site, const MacAddress& transmitter) {
  const SiteTransmitter* stated = find_transmitter(site, transmitter);
  return stated == nullptr ? site.targets.track_unlisted : stated->role == TransmitterRole::kDevice;
}

// In the order in which they end.
std::vector<Frames> bursts_of(Frames frames) {
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  std::vector<Frames> bursts;
  std::map<MacAddress, std::size_t> open;
  for (CsiFrame& frame : frames) {
    const auto found = open.find(frame.transmitter);
    if (found == open.end() || frame.time - bursts[found->second].front().time >= kBurst) {
      open[frame.transmitter] = bursts.size();
      bursts.emplace_back();
    }
    bursts[open[frame.transmitter]].push_back(std::move(frame));
  }
  std::stable_sort(bursts.begin(), bursts.end(), [](const Frames& a, const Frames& b) {
    return a.back().time < b.back().time;
  });
  return bursts;
}

}  // namespace

Expected<std::vector<ChainState>> learn_chains(const Site& site,
                                               const RoomModel& room,
                                               const std::vector<CaptureArgument>& captures,
                                               std::vector<std::string>& notes) {
  Frames frames;
  std::set<std::size_t> heard;
  bool is_any_device = false;
  for (const RecordingArgument& recording : recordings_of(captures)) {
    const auto keep = [&](CsiFrame&& frame) {
      const SiteTransmitter* fixed = find_fixed_transmitter(site, frame.transmitter);
      const bool is_of_device = is_device(site, frame.transmitter);
      if (is_of_device || (fixed != nullptr && fixed->position)) {
        is_any_device |= is_of_device;
        heard.insert(static_cast<std::size_t>(frame.access_point));
        frames.push_back(std::move(frame));
      }
    };
    if (auto read = for_each_frame(site, recording, keep, notes); !read) {
      return tl::make_unexpected(std::move(read.error()));
    }
  }
  if (!is_any_device) {
    return std::vector<ChainState>();
  }
  RoomModel of_devices = room;
  of_devices.device = unlisted_device(site);
  auto localizer = Localizer::create(std::make_shared<const RoomModel>(std::move(of_devices)), {});
  if (!localizer) {
    return tl::make_unexpected(std::move(localizer.error()));
  }
  ChainLearner learner(std::make_shared<const Localizer>(*std::move(localizer)));
  const std::vector<Frames> bursts = bursts_of(std::move(frames));
  for (const std::size_t access_point : heard) {
    learner.power_cycled(access_point, bursts.front().front().time);
  }
  for (const Frames& burst : bursts) {
    const SiteTransmitter* fixed = find_fixed_transmitter(site, burst.front().transmitter);
    if (fixed != nullptr && fixed->position) {
      learner.hear(burst, *fixed->position);
    } else {
      learner.hear(burst);
    }
  }
  return learner.states();
}

ChainGains multiplied(const ChainGains& gains, const ChainFactors& factors) {
  ChainGains result = gains;
  const std::size_t tones = gains.gain.size() / gains.cores.size();
  double power = 0.0;
  for (std::size_t i = 0; i < result.gain.size(); ++i) {
    result.gain[i] *= factors.factor[i / tones];
    power += std::norm(result.gain[i]) / static_cast<double>(result.gain.size());
  }
  for (std::complex<double>& gain : result.gain) {
    gain /= std::sqrt(power);
  }
  return result;
}

}  // namespace rayloc::cli
