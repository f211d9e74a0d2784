#include "daemon/lab/calibrate/learned_chains.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <memory>
#include <utility>

#include "daemon/lab/calibrate/device_bursts.h"
#include "engine/chains/chain_learner.h"
#include "engine/localize/localizer.h"

namespace rayloc {
namespace {

std::size_t learned_of(const std::vector<ChainState>& states) {
  return static_cast<std::size_t>(
      std::count_if(states.begin(), states.end(), [](const ChainState& state) {
        return state.knowledge == ChainKnowledge::kLearned;
      }));
}

// Processes all bursts again from the learned chains: calibrated access points then locate the
// devices, which was not possible for early bursts in the first pass.
std::vector<ChainState> learn_once_more(const Site& site,
                                        const std::shared_ptr<const Localizer>& localizer,
                                        const DeviceBursts& received,
                                        const std::vector<ChainState>& before) {
  ChainLearner learner(localizer);
  for (const std::size_t access_point : received.receivers) {
    const auto known = std::find_if(before.begin(), before.end(), [&](const ChainState& state) {
      return state.access_point == access_point && state.knowledge == ChainKnowledge::kLearned;
    });
    if (known != before.end()) {
      learner.adopt(*known);
    } else {
      learner.power_cycled(access_point, received.bursts.front().front().time);
    }
  }
  for (const std::vector<CsiFrame>& burst : received.bursts) {
    const SiteTransmitter* fixed = find_fixed_transmitter(site, burst.front().transmitter);
    if (fixed != nullptr && fixed->position) {
      learner.receive(burst, *fixed->position);
    } else {
      learner.receive(burst);
    }
  }
  return learner.states();
}

}  // namespace

Expected<std::vector<ChainState>> learn_chains(const Site& site,
                                               const RoomModel& room,
                                               const std::vector<CaptureArgument>& captures,
                                               std::vector<std::string>& notes) {
  const auto received = read_device_bursts(site, captures, notes);
  RAYLOC_TRY(received);
  if (!received->is_any_device) {
    return std::vector<ChainState>();
  }
  const auto localizer = device_localizer(site, room);
  RAYLOC_TRY(localizer);
  std::vector<ChainState> states;
  std::size_t known = 0;
  do {
    known = learned_of(states);
    std::vector<ChainState> again = learn_once_more(site, *localizer, *received, states);
    if (states.empty() || learned_of(again) > known) {
      states = std::move(again);
    }
  } while (learned_of(states) > known && learned_of(states) < received->receivers.size());
  return states;
}

ChainGains multiplied(const ChainGains& gains, const ChainFactors& factors) {
  ChainGains result = gains;
  const std::size_t tones = gains.gain.size() / gains.rx_chains.size();
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

}  // namespace rayloc
