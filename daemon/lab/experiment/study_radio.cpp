#include "daemon/lab/experiment/study_radio.h"

#include <algorithm>
#include <cmath>

#include "capture/assemble/csi_receiver.h"

namespace rayloc {

ChainGains before_changes(ChainGains gains, const std::vector<std::complex<double>>& changes) {
  const std::size_t tones = gains.grid.size();
  for (std::size_t i = 0; i < changes.size() * tones; ++i) {
    gains.gain[i] /= changes[i / tones];
  }
  return gains;
}

ChainGains gains_on_grid(const ChainGains& all, const OfdmGrid& grid) {
  ChainGains gains{grid, all.rx_chains, {}, all.coupling};
  for (std::size_t rx_chain = 0; rx_chain < all.rx_chains.size(); ++rx_chain) {
    for (const std::int16_t tone : grid.tone_index) {
      const auto found =
          std::lower_bound(all.grid.tone_index.begin(), all.grid.tone_index.end(), tone);
      gains.gain.push_back(all.gain[rx_chain * all.grid.size() +
                                    static_cast<std::size_t>(found - all.grid.tone_index.begin())]);
    }
  }
  return gains;
}

std::vector<CsiFrame> decoded_frames(const PointCapture& capture,
                                     const RoomAccessPoint& ap,
                                     std::size_t index) {
  CsiReceiverOptions options;
  options.access_point = index;
  options.expected_rx_chains = ap.rx_chains;
  CsiReceiver receiver(options);
  std::vector<CsiFrame> frames;
  for (const SimulatedDatagram& datagram : capture.datagrams) {
    receiver.push({datagram.time, {}, datagram.payload}, frames);
  }
  receiver.flush(frames);
  return frames;
}

std::size_t nearest_channel(std::span<const RoomModel> rooms, const RoomModel& model) {
  const auto away = [&](const RoomModel& room) {
    return std::abs(room.grid.centre_hz - model.grid.centre_hz);
  };
  return static_cast<std::size_t>(
      std::min_element(rooms.begin(),
                       rooms.end(),
                       [&](const auto& a, const auto& b) { return away(a) < away(b); }) -
      rooms.begin());
}

}  // namespace rayloc
